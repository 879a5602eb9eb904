// OpenCV's integral image: its sums in float, double or, of 8-bit textures, 32-bit integers. It makes the
// table and has no query of its own; its tables are asked as ours are, with fractional borders.
#include <opencv2/imgproc.hpp>

#include "bench/core/registry.hpp"
#include "bench/region_average/method.hpp"
#include "shading/texture/region_averager.hpp"
#include "shading/texture/summed_area.hpp"

namespace treeline::bench::region_average {
namespace {

namespace texture = shading::texture;

/// Entry: of the table; Value: of the texture it is given.
template <class Entry, class Value>
class Integral final : public Averager {
 public:
  Integral(const Input& input, double top) : scale_(1 / top) {
    if constexpr (std::is_same_v<Value, unsigned char>) {
      eight_bits_.reserve(input.image.values.size());
      for (const float v : input.image.values) {
        const float level = std::floor(v * 255 + 0.5f);
        if (!(v >= 0 && v <= 1 && level / 255 == v))
          throw Unsupported("takes textures of 8 bits, and this one has other values");
        eight_bits_.push_back(static_cast<unsigned char>(level));
      }
    }
    rebuild(input.image, input.threads);
  }

  void rebuild(const Image& image, int threads) override {
    cv::setNumThreads(threads);
    const int channels = image.channels;
    const void* values = image.values.data();
    if constexpr (std::is_same_v<Value, unsigned char>) values = eight_bits_.data();
    const cv::Mat from(image.height, image.width, CV_MAKETYPE(cv::DataType<Value>::depth, channels),
                       const_cast<void*>(values));
    cv::integral(from, sums_, cv::DataType<Entry>::depth);
    width_ = image.width, height_ = image.height, channels_ = channels;
  }
  void means(std::span<const Footprint> footprints, const Knobs&, int threads,
             std::span<float> out) const override {
    texture::means(*this, footprints, out, threads);
  }

  int width() const { return width_; }
  int height() const { return height_; }
  int channels() const { return channels_; }
  std::size_t bytes() const { return sums_.total() * sums_.elemSize(); }
  void mean(const Footprint& f, float* out) const {
    // Integers wrap, and their differences wrap back.
    using Read = std::conditional_t<std::is_same_v<Entry, int>, std::uint32_t, Entry>;
    const texture::TableView<Read> table{reinterpret_cast<const Read*>(sums_.data),
                                         static_cast<std::ptrdiff_t>(sums_.step / sizeof(Entry)), width_,
                                         height_, channels_};
    texture::with_channels(channels_, [&](auto count) {
      double found[count];
      texture::box_means<count>(table, texture::fitted_box(f), found);
      for (int c = 0; c < count; ++c) out[c] = static_cast<float>(found[c] * scale_);
    });
  }

 private:
  std::vector<unsigned char> eight_bits_;
  cv::Mat sums_;
  double scale_;
  int width_ = 0, height_ = 0, channels_ = 0;
};

std::unique_ptr<Averager> build(const Input& input, const Knobs& knobs) {
  texture::check_shape(input.image);
  const std::string& sums = knobs.at("sums").get_ref<const std::string&>();
  if (sums == "float") return std::make_unique<Integral<float, float>>(input, 1);
  if (sums == "double") return std::make_unique<Integral<double, float>>(input, 1);
  return std::make_unique<Integral<int, unsigned char>>(input, 255);
}

[[maybe_unused]] const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "opencv_integral",
              .family = "sat",
              .source = Source::peer,
              .claim = Claim::approximate,
              .peer_version = CV_VERSION,
              .build_knobs = {{{"sums", "float"}}, {{"sums", "double"}}, {{"sums", "int32"}}},
              .stress_builds = {0, 1, 2},
              .ladder = 50},
     .build = build,
     .boxes_only = true});

}  // namespace
}  // namespace treeline::bench::region_average
