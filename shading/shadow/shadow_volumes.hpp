// Shadow volumes: hard shadows by counting how often the way of an eye ray enters and leaves them.
//
// Sources: Crow 1977; Heidmann 1991 (counting before the receiver: z-pass); Bilodeau and Songy 1999, Carmack
// 2000 (behind it: z-fail); Everitt and Kilgard 2002 (points at infinity); Olano and Greer 1997 (rasterising
// in homogeneous coordinates, without clipping). Method: the boundary's faces (volume_boundary.hpp) are drawn
// over the camera's pixels, and at each receiver in a pixel that a face may cover, it is decided in double
// whether the ray from the eye crosses the face, and whether before or behind the receiver; both counts are
// taken in one pass. An edge is decided once for both of its faces, bit for bit. z-fail tells in how many
// volumes a receiver lies, wherever the eye is; z-pass tells that less the number around the eye. Cost: a
// row of pixels for each row that a face covers: without bound, volumes cross the whole image. Known
// weakness: z-fail needs both caps and nothing clipped at the back; z-pass, the eye in light and nothing
// clipped in front. Light is a point.
#pragma once

#include "geometry/rounding.hpp"
#include "shading/shadow/method.hpp"
#include "shading/shadow/surface_offset.hpp"
#include "shading/shadow/volume_boundary.hpp"

namespace treeline::shading::shadow {

enum class VolumeTest { z_pass, z_fail };

struct ShadowVolumeOptions {
  VolumeTest test = VolumeTest::z_fail;  ///< what visibility() goes by
  VolumeOptions volumes;
  /// Clipping planes: crossings at other depths along the camera's axis are not counted. World units.
  double near = 0, far = INFINITY;
};

/// Volumes entered less volumes left on the way from the eye to a receiver; volumes left less entered from
/// there on. Integers of few bits wrap around, as those of a stencil buffer do.
template <std::signed_integral T = int>
struct VolumeCounts {
  T before = 0, behind = 0;
  bool operator==(const VolumeCounts&) const = default;
};

class ShadowVolumes {
 public:
  /// Throws InvalidScene as VolumeBoundary does, and for a camera that is none.
  explicit ShadowVolumes(const Scene& scene, const ShadowVolumeOptions& options = {});

  /// Looks at every face.
  template <std::signed_integral T = int>
  VolumeCounts<T> count(const Receiver& receiver) const {
    VolumeCounts<T> counts;
    const Way way = way_to(receiver);
    for (const Face& face : faces_) cross(face, way, counts);
    return counts;
  }
  /// The same numbers, by drawing the faces where receivers are in the camera's image; those beside it are
  /// asked singly. Throws InvalidScene where there is not room for as many answers.
  template <std::signed_integral T>
  void count(std::span<const Receiver> receivers, std::span<VolumeCounts<T>> counts) const;

  /// 1 or 0.
  float visibility(const Receiver& receiver) const { return lit(count<int>(receiver)); }
  template <std::signed_integral T = std::int16_t>
  void visibility(std::span<const Receiver> receivers, std::span<float> answers) const {
    detail::check_room(receivers.size(), answers.size());
    std::vector<VolumeCounts<T>> counts(receivers.size());
    count(receivers, std::span(counts));
    for (std::size_t i = 0; i < answers.size(); ++i) answers[i] = lit(counts[i]);
  }

  std::size_t faces() const { return faces_.size(); }
  std::size_t silhouette_edges() const { return silhouette_edges_; }
  std::size_t bytes() const { return faces_.size() * sizeof(Face); }

 private:
  /// A boundary face as seen from the eye.
  struct Face {
    std::array<Vec3d, 4> sides;  // normals of the planes through the eye and a side, lower corner first
    Vec3d plane;                 // outward normal; zero for a face at infinity
    double offset;               // its product with a corner; > 0: the face is left by rays, < 0: entered
    float top, bottom;           // rows of the image that it may be in
    std::int16_t multiplicity;
    std::uint8_t size, inward;  // bit i: inside is where the product with side i is ≥ 0
  };
  struct Way {
    Vec3d to;      // receiver, from the eye
    double depth;  // along the camera's axis
  };

  template <class T>
  float lit(const VolumeCounts<T>& c) const {
    return (options_.test == VolumeTest::z_pass ? c.before : c.behind) == 0 ? 1.0f : 0.0f;
  }
  Way way_to(const Receiver& r) const {
    const Vec3d to = r.position + r.normal * offset_ - eye_;
    return {to, dot(to, forward_)};
  }
  /// Every product of a side is made here, so that both faces at an edge get the same.
  static bool on_positive_side(const Vec3d& side, const Vec3d& to) {
    using geometry::rounded;
    return rounded(side[0] * to[0]) + rounded(side[1] * to[1]) + rounded(side[2] * to[2]) >= 0;
  }
  template <class T>
  void cross(const Face& face, const Way& way, VolumeCounts<T>& counts) const {
    for (int i = 0; i < face.size; ++i)
      if (on_positive_side(face.sides[static_cast<std::size_t>(i)], way.to) != bool(face.inward >> i & 1))
        return;
    const double speed = std::abs(dot(face.plane, way.to)), reach = std::abs(face.offset);
    // The crossing is at reach / speed of the way, at infinity for 0.
    const double depth = reach * way.depth;
    if (depth < options_.near * speed || depth > options_.far * speed) return;
    const int entered = face.offset < 0 ? face.multiplicity : -face.multiplicity;
    if (reach < speed)
      counts.before = static_cast<T>(counts.before + entered);
    else
      counts.behind = static_cast<T>(counts.behind - entered);
  }

  void look(const VolumeBoundary& boundary);
  void find_rows(Face& face, const VolumeBoundary::Face& from, const std::vector<Homogeneous>& seen) const;

  ShadowVolumeOptions options_;
  Vec3d eye_, forward_, right_, up_;
  int width_, height_;
  double tan_x_, tan_y_;  // of half the image
  double offset_;
  std::vector<Face> faces_;
  std::size_t silhouette_edges_ = 0;
};

inline ShadowVolumes::ShadowVolumes(const Scene& scene, const ShadowVolumeOptions& options)
    : options_(options),
      eye_(scene.camera.position),
      width_(scene.camera.width),
      height_(scene.camera.height),
      offset_(surface_offset<float>(scene)) {
  const Camera& c = scene.camera;
  const Vec3d ahead = c.target - c.position, side = geometry::cross(ahead, c.up);
  if (!is_finite(c.position) || !is_finite(ahead) || !(length(side) > 0) || width_ < 1 || height_ < 1 ||
      !(c.height_angle > 0 && c.height_angle < std::numbers::pi))
    throw InvalidScene("the camera has no view: its place, axis, angle or size");
  if (!(options.near >= 0) || !(options.far > options.near))
    throw InvalidScene("near must not be negative, and far be beyond it");
  forward_ = normalized(ahead), right_ = normalized(side), up_ = geometry::cross(right_, forward_);
  tan_y_ = std::tan(0.5 * c.height_angle), tan_x_ = tan_y_ * width_ / height_;
  const VolumeBoundary boundary(scene, options.volumes);
  silhouette_edges_ = boundary.silhouette_edges();
  look(boundary);
}

inline void ShadowVolumes::look(const VolumeBoundary& boundary) {
  std::vector<Homogeneous> seen = boundary.points();
  for (Homogeneous& p : seen)
    if (p.w != 0) p.at = p.at - eye_;
  const auto side_of = [&](std::uint32_t low, std::uint32_t high) {
    return geometry::cross(seen[low].at, seen[high].at);
  };
  faces_.reserve(boundary.faces().size());
  for (const VolumeBoundary::Face& from : boundary.faces()) {
    const auto corner = [&](int i) { return from.corners[static_cast<std::size_t>(i % from.size)]; };
    const Homogeneous &a = seen[corner(0)], &b = seen[corner(1)], &c = seen[corner(2)];
    Face face{};
    if (a.w != 0) {
      face.plane = geometry::cross(b.at - a.at, c.w != 0 ? c.at - a.at : c.at);
      face.offset = dot(face.plane, a.at);
    } else {
      face.offset = dot(a.at, geometry::cross(b.at, c.at));
    }
    if (face.offset == 0) continue;  // edge-on: no ray from the eye crosses it
    face.size = static_cast<std::uint8_t>(from.size);
    face.multiplicity = static_cast<std::int16_t>(from.multiplicity);
    for (int i = 0; i < from.size; ++i) {
      const std::uint32_t low = std::min(corner(i), corner(i + 1)), high = std::max(corner(i), corner(i + 1));
      face.sides[static_cast<std::size_t>(i)] = side_of(low, high);
      if ((low == corner(i)) == (face.offset > 0))
        face.inward = static_cast<std::uint8_t>(face.inward | 1 << i);
    }
    find_rows(face, from, seen);
    faces_.push_back(face);
  }
}

/// Those between its corners, if all of them are in front of the eye; all rows, if some are.
inline void ShadowVolumes::find_rows(Face& face, const VolumeBoundary::Face& from,
                                     const std::vector<Homogeneous>& seen) const {
  int ahead = 0;
  double top = INFINITY, bottom = -INFINITY;
  for (int i = 0; i < from.size; ++i) {
    const Vec3d& p = seen[from.corners[static_cast<std::size_t>(i)]].at;
    const double z = dot(p, forward_);
    if (!(z > 0)) continue;
    ++ahead;
    const double y = (1 - dot(p, up_) / (z * tan_y_)) * 0.5 * height_;
    top = std::min(top, y), bottom = std::max(bottom, y);
  }
  const auto row = [&](double y) { return static_cast<float>(std::clamp(y, -1.0, height_ + 1.0)); };
  face.top = 0, face.bottom = ahead == 0 ? -1.0f : static_cast<float>(height_ - 1);
  if (ahead == from.size) face.top = std::max(0.0f, row(top - 1)), face.bottom = row(bottom + 1);
}

template <std::signed_integral T>
void ShadowVolumes::count(std::span<const Receiver> receivers, std::span<VolumeCounts<T>> counts) const {
  detail::check_room(receivers.size(), counts.size());
  const std::size_t pixels = std::size_t(width_) * std::size_t(height_);
  constexpr std::uint32_t beside = 0xffffffffu;
  std::vector<std::uint32_t> pixel(receivers.size(), beside), first(pixels + 1);
  std::vector<Way> ways(receivers.size());
  for (std::size_t i = 0; i < receivers.size(); ++i) {
    counts[i] = {};
    ways[i] = way_to(receivers[i]);
    const Vec3d& to = ways[i].to;
    const double x = (1 + dot(to, right_) / (ways[i].depth * tan_x_)) * 0.5 * width_,
                 y = (1 - dot(to, up_) / (ways[i].depth * tan_y_)) * 0.5 * height_;
    if (ways[i].depth > 0 && x >= 0 && x < width_ && y >= 0 && y < height_)
      ++first[(pixel[i] = std::uint32_t(y) * std::uint32_t(width_) + std::uint32_t(x)) + 1];
    else
      for (const Face& face : faces_) cross(face, ways[i], counts[i]);
  }
  std::partial_sum(first.begin(), first.end(), first.begin());
  struct Seen {
    Way way;
    VolumeCounts<T> counts;
    std::uint32_t receiver;
  };
  std::vector<Seen> seen(first.back());
  std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
  for (std::size_t i = 0; i < receivers.size(); ++i)
    if (pixel[i] != beside) seen[next[pixel[i]]++] = {ways[i], {}, static_cast<std::uint32_t>(i)};

  for (const Face& face : faces_) {
    // A side's product over the image: a x + b y + c in pixels, ≥ 0 inside. `slack` is what it may grow by
    // within a pixel, and by rounding.
    struct Line {
      double a, b, c;
    } lines[4];
    for (int i = 0; i < face.size; ++i) {
      const Vec3d side = face.sides[static_cast<std::size_t>(i)] * (face.inward >> i & 1 ? 1.0 : -1.0);
      const double x = dot(side, right_) * tan_x_, y = dot(side, up_) * tan_y_, z = dot(side, forward_);
      Line& l = lines[i];
      l.a = 2 * x / width_, l.b = -2 * y / height_, l.c = z - x + y;
      const double slack = 1e-9 * (std::abs(x) + std::abs(y) + std::abs(z));
      l.c += 0.5 * (l.a + l.b + std::abs(l.a) + std::abs(l.b)) + slack;
    }
    const int last_row = std::min(static_cast<int>(face.bottom), height_ - 1);
    for (int row = static_cast<int>(face.top); row <= last_row; ++row) {
      double begin = 0, end = width_ - 1;
      for (int i = 0; i < face.size; ++i) {
        const Line& l = lines[i];
        const double at = l.b * row + l.c;
        if (l.a > 0)
          begin = std::max(begin, -at / l.a - 1e-6);
        else if (l.a < 0)
          end = std::min(end, -at / l.a + 1e-6);
        else if (at < 0)
          end = -1;
      }
      if (!(begin <= end)) continue;
      const std::size_t start = std::size_t(row) * std::size_t(width_);
      const std::uint32_t stop = first[start + static_cast<std::size_t>(end) + 1];
      for (std::uint32_t n = first[start + static_cast<std::size_t>(std::ceil(begin))]; n < stop; ++n)
        cross(face, seen[n].way, seen[n].counts);
    }
  }
  for (const Seen& s : seen) counts[s.receiver] = s.counts;
}

static_assert(ShadowMethod<ShadowVolumes>);

}  // namespace treeline::shading::shadow
