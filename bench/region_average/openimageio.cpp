// OpenImageIO's texture system: what production renderers ask. It makes its own pyramid into a file, reads
// tiles of it into a cache, and is asked by handle, with the footprint's axes as derivatives.
//
// Best settings: floats, no compression, a cache that holds the whole texture, bilinear look-ups (its
// default, bicubic where a texel is magnified, costs more and is no mean). The build reads all tiles into the
// cache, so that its bytes are what look-ups keep, as everyone's are. It takes derivatives for the width
// of a filter that is wider than the footprint, as every look-up between texels is: width 0.58 gives ours
// bias.
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imagecache.h>
#include <OpenImageIO/texture.h>

#include <filesystem>
#include <random>

#include "accel/batch.hpp"
#include "bench/core/registry.hpp"
#include "bench/region_average/method.hpp"
#include "shading/texture/region_averager.hpp"

namespace treeline::bench::region_average {
namespace {

namespace texture = shading::texture;

class TextureFile {
 public:
  TextureFile() {
    std::random_device random;
    path_ = (std::filesystem::temp_directory_path() /
             ("treeline_" + std::to_string(random()) + std::to_string(random()) + ".tx"))
                .string();
  }
  ~TextureFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  TextureFile(const TextureFile&) = delete;
  TextureFile& operator=(const TextureFile&) = delete;
  const std::string& path() const { return path_; }

  void make(const Image& image, int threads) const {
    const OIIO::ImageSpec spec(image.width, image.height, image.channels, OIIO::TypeDesc::FLOAT);
    const OIIO::ImageBuf pixels(spec, const_cast<float*>(image.values.data()));
    OIIO::ImageSpec config;
    config.format = OIIO::TypeDesc::FLOAT;
    config.attribute("compression", "none");
    config.attribute("maketx:filtername", "box");
    config.attribute("maketx:nthreads", threads);
    if (!OIIO::ImageBufAlgo::make_texture(OIIO::ImageBufAlgo::MakeTxTexture, pixels, path_, config))
      throw std::runtime_error("OpenImageIO makes no texture of it: " + OIIO::geterror());
  }

 private:
  std::string path_;
};

class TextureSystem final : public Averager {
 public:
  explicit TextureSystem(const Input& input) : system_(OIIO::TextureSystem::create(false)) {
    texture::check_shape(input.image);
    texture::check_finite(input.image);
    system_->attribute("max_memory_MB", 4096.0f);
    OIIO::attribute("threads", input.threads);
    width_ = input.image.width, height_ = input.image.height, channels_ = input.image.channels;
    rebuild(input.image, input.threads);
    fill_cache();
  }
  ~TextureSystem() override { OIIO::TextureSystem::destroy(system_); }

  void rebuild(const Image& image, int threads) override {
    file_.make(image, threads);
    system_->invalidate(OIIO::ustring(file_.path()));
    handle_ = system_->get_texture_handle(OIIO::ustring(file_.path()));
    if (!handle_ || !system_->good(handle_))
      throw std::runtime_error("OpenImageIO cannot read its texture: " + system_->geterror());
  }
  void means(std::span<const Footprint> footprints, const Knobs& knobs, int threads,
             std::span<float> out) const override {
    OIIO::TextureOpt options;
    options.swrap = options.twrap = OIIO::TextureOpt::WrapClamp;
    options.interpmode = OIIO::TextureOpt::InterpBilinear;
    options.mipmode = knobs.at("filter") == "trilinear" ? OIIO::TextureOpt::MipModeTrilinear
                                                        : OIIO::TextureOpt::MipModeAniso;
    options.anisotropic = 16;
    options.swidth = options.twidth = knobs.at("width").get<float>();
    accel::parallel_ranges(footprints.size(), threads, [&](std::size_t begin, std::size_t end) {
      OIIO::TextureSystem::Perthread* own = system_->get_perthread_info();
      for (std::size_t i = begin; i < end; ++i) {
        const Footprint& f = footprints[i];
        const double k = 2 * texture::box_factor(f.shape);
        OIIO::TextureOpt mine = options;
        const bool good = system_->texture(
            handle_, own, mine, static_cast<float>(f.x / width_), static_cast<float>(f.y / height_),
            static_cast<float>(k * f.ux / width_), static_cast<float>(k * f.uy / height_),
            static_cast<float>(k * f.vx / width_), static_cast<float>(k * f.vy / height_), channels_,
            out.data() + i * static_cast<std::size_t>(channels_));
        if (!good) throw std::runtime_error("OpenImageIO: " + system_->geterror());
      }
    });
  }

 private:
  void fill_cache() const {
    OIIO::ImageCache* const cache = system_->imagecache();
    const OIIO::ustring name(file_.path());
    int levels = 0;
    if (!cache->get_image_info(name, 0, 0, OIIO::ustring("miplevels"), OIIO::TypeDesc::INT, &levels))
      throw std::runtime_error("OpenImageIO does not know its texture: " + cache->geterror());
    for (int level = 0; level < levels; ++level) {
      const OIIO::ImageSpec* const spec = cache->imagespec(name, 0, level);
      if (!spec) throw std::runtime_error("OpenImageIO cannot read its texture: " + cache->geterror());
      for (int y = 0; y < spec->height; y += std::max(1, spec->tile_height))
        for (int x = 0; x < spec->width; x += std::max(1, spec->tile_width)) {
          OIIO::ImageCache::Tile* const tile = cache->get_tile(name, 0, level, x, y, 0);
          if (!tile) throw std::runtime_error("OpenImageIO cannot read a tile: " + cache->geterror());
          cache->release_tile(tile);
        }
    }
  }

  TextureFile file_;
  OIIO::TextureSystem* system_;
  OIIO::TextureSystem::TextureHandle* handle_ = nullptr;
  int width_ = 0, height_ = 0, channels_ = 0;
};

[[maybe_unused]] const bool registered = Registry<Method>::instance().add(
    {.info = {.name = "openimageio",
              .family = "mip",
              .source = Source::peer,
              .claim = Claim::approximate,
              .peer_version = OIIO_VERSION_STRING,
              .query_knobs = {{{"filter", "trilinear"}, {"width", 1.0}},
                              {{"filter", "trilinear"}, {"width", 0.58}},
                              {{"filter", "anisotropic"}, {"width", 0.58}},
                              {{"filter", "anisotropic"}, {"width", 1.0}}},
              .ladder = 51},
     .build = [](const Input& input, const Knobs&) -> std::unique_ptr<Averager> {
       return std::make_unique<TextureSystem>(input);
     }});

}  // namespace
}  // namespace treeline::bench::region_average
