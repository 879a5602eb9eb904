#include "datasets_gen/scenes/light.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

namespace treeline::datasets {
namespace {

using geometry::Vec3d;
using shading::Light;
using shading::LightKind;

constexpr double degree = std::numbers::pi / 180;

/// The parts of a light's description between colons.
class Reader {
 public:
  explicit Reader(std::string_view text) : text_(text) {
    for (std::size_t begin = 0;;) {
      const std::size_t end = std::min(text.find(':', begin), text.size());
      parts_.push_back(text.substr(begin, end - begin));
      if (end == text.size()) return;
      begin = end + 1;
    }
  }

  [[noreturn]] void refuse(const std::string& why) const {
    throw std::invalid_argument("light '" + std::string(text_) + "': " + why + " (" + light_syntax + ")");
  }
  std::string_view kind() const { return parts_[0]; }
  std::size_t count() const { return parts_.size() - 1; }
  void expect(std::size_t low, std::size_t high) const {
    if (count() < low || count() > high)
      refuse("it has " + std::to_string(count()) + " parts after the kind; a " + std::string(kind()) +
             " has " + std::to_string(low) + (low == high ? std::string() : " or " + std::to_string(high)));
  }
  template <std::size_t N>
  std::array<double, N> numbers(std::size_t part, const char* what) const {
    std::array<double, N> r{};
    std::string_view rest = parts_[part];
    const auto fail = [&](const std::string& why) {
      refuse(std::string(what) + " '" + std::string(parts_[part]) + "' (part " + std::to_string(part) +
             " after the kind) " + why);
    };
    for (std::size_t k = 0; k < N; ++k) {
      const std::string_view one = rest.substr(0, rest.find(','));
      const auto [end, error] = std::from_chars(one.data(), one.data() + one.size(), r[k]);
      if (error != std::errc() || end != one.data() + one.size() || !std::isfinite(r[k]))
        fail("has '" + std::string(one) + "' for number " + std::to_string(k + 1) + " of " +
             std::to_string(N));
      rest.remove_prefix(one.size());
      if (k + 1 < N && rest.empty())
        fail("has " + std::to_string(k + 1) + " numbers, not " + std::to_string(N));
      if (!rest.empty()) rest.remove_prefix(1);
      if (k + 1 == N && one.data() + one.size() != parts_[part].data() + parts_[part].size())
        fail("has more than " + std::to_string(N) + " numbers");
    }
    return r;
  }
  Vec3d point(std::size_t part) const {
    const auto v = numbers<3>(part, "position");
    return {v[0], v[1], v[2]};
  }
  Vec3d direction(std::size_t part) const {
    const auto v = numbers<3>(part, "direction");
    const double l = std::hypot(v[0], v[1], v[2]);
    if (!(l > 0) || !std::isfinite(l))
      refuse("direction '" + std::string(parts_[part]) + "' has no finite length");
    return {v[0] / l, v[1] / l, v[2] / l};
  }
  /// A positive number below a limit.
  double measure(double value, const char* what, double limit) const {
    if (!(value > 0 && value < limit))
      refuse(std::string(what) + " is " + std::to_string(value) + "; it must be above 0 and below " +
             std::to_string(limit));
    return value;
  }

 private:
  std::string_view text_;
  std::vector<std::string_view> parts_;
};

void set_axes(Light& light, double half_width, double half_height) {
  const Vec3d helper = std::abs(light.direction[1]) < 0.9 ? Vec3d{0, 1, 0} : Vec3d{1, 0, 0};
  const Vec3d right = normalized(cross(light.direction, helper));
  light.u = right * half_width, light.v = cross(light.direction, right) * half_height;
}

}  // namespace

Light parse_light(std::string_view text) {
  const Reader in(text);
  Light light;
  constexpr double largest = 1e30;
  if (in.kind() == "directional") {
    in.expect(1, 2);
    light.kind = LightKind::directional, light.direction = in.direction(1);
    if (in.count() == 2) {
      const double angle = in.numbers<1>(2, "angle")[0];
      if (!(angle >= 0 && angle < 90))
        in.refuse("the half angle is " + std::to_string(angle) + "; it must be from 0 and below 90 degrees");
      light.angle = angle * degree;
    }
  } else if (in.kind() == "point") {
    in.expect(1, 1);
    light.kind = LightKind::point, light.position = in.point(1);
  } else if (in.kind() == "spot") {
    in.expect(3, 3);
    light.kind = LightKind::spot, light.position = in.point(1), light.direction = in.direction(2);
    light.angle = degree * in.measure(in.numbers<1>(3, "angle")[0], "the angle", 90);
  } else if (in.kind() == "rectangle") {
    in.expect(3, 3);
    light.kind = LightKind::rectangle, light.position = in.point(1), light.direction = in.direction(2);
    const auto [w, h] = in.numbers<2>(3, "size");
    set_axes(light, 0.5 * in.measure(w, "the width", largest), 0.5 * in.measure(h, "the height", largest));
  } else if (in.kind() == "disc") {
    in.expect(3, 3);
    light.kind = LightKind::disc, light.position = in.point(1), light.direction = in.direction(2);
    const double radius = in.measure(in.numbers<1>(3, "radius")[0], "the radius", largest);
    set_axes(light, radius, radius);
  } else {
    in.refuse(std::string("'").append(in.kind()).append("' is no kind of light"));
  }
  return light;
}

std::string format_light(const Light& light) {
  const auto number = [](double x) {
    char buffer[32];
    const auto end = std::to_chars(buffer, buffer + sizeof buffer, x).ptr;
    return std::string(buffer, end);
  };
  const auto vector = [&](const Vec3d& v) { return number(v[0]) + "," + number(v[1]) + "," + number(v[2]); };
  const std::string at = vector(light.position), along = vector(light.direction);
  const double u = length(light.u), v = length(light.v);
  const std::string placed = at + ":" + along + ":", angle = number(light.angle / degree);
  std::string r;
  switch (light.kind) {
    case LightKind::directional:
      r.append("directional:").append(along);
      return light.angle > 0 ? r.append(":").append(angle) : r;
    case LightKind::point:
      return r.append("point:").append(at);
    case LightKind::spot:
      return r.append("spot:").append(placed).append(angle);
    case LightKind::rectangle:
      return r.append("rectangle:").append(placed).append(number(2 * u)).append(",").append(number(2 * v));
    case LightKind::disc:
      return r.append("disc:").append(placed).append(number(u));
  }
  return r;
}

}  // namespace treeline::datasets
