// treeline_render ROOM|FILE OUT.exr [OUT.png]: path traces a room, or a user's mesh under a lamp and a sky.
//
// Radiance goes to the EXR file as it is, and as a screen shows it to the PNG file. A line on stderr tells
// samples, time and the estimated relative error; on a terminal it is rewritten. An interrupt ends it with
// what has been traced. Exit status: 0 done, be the error asked for reached or not; 2 unusable arguments or
// files.
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <csignal>
#include <ctime>
#include <filesystem>
#include <new>

#include "bench/core/all_threads.hpp"
#include "bench/core/progress.hpp"
#include "bench/core/table.hpp"
#include "bench/light_transport/pictures.hpp"
#include "bench/light_transport/tracer.hpp"
#include "datasets_gen/files/read.hpp"
#include "datasets_gen/files/write.hpp"
#include "datasets_gen/rooms/room.hpp"
#include "datasets_gen/whole_number.hpp"

namespace {

namespace bench = treeline::bench;
namespace datasets = treeline::datasets;
namespace light = treeline::bench::light_transport;
using treeline::shading::Image;
using Clock = std::chrono::steady_clock;

volatile std::sig_atomic_t interrupted = 0;

struct Arguments {
  std::string scene, exr, png;
  double n = 5000;
  int samples = 256, threads = bench::all_threads(), width = 0, height = 0;
  double error = 0, exposure = 0;
  std::uint64_t seed = 1;
  bool force = false;
};

constexpr int largest_side = 16384;

treeline::shading::LitScene read_room(const Arguments& a) {
  if (datasets::is_room(a.scene)) return datasets::make_room(a.scene, static_cast<std::size_t>(a.n), a.seed);
  if (!std::filesystem::exists(a.scene)) {
    std::string known;
    for (const datasets::KnobRecipe& r : datasets::room_recipes())
      known += (known.empty() ? "" : ", ") + r.name;
    throw std::invalid_argument(a.scene + " is neither a file nor a room; rooms are " + known);
  }
  datasets::Dataset data = datasets::read(a.scene);
  if (data.kind != datasets::Kind::mesh) throw std::invalid_argument(a.scene + " holds no mesh");
  for (const std::string& note : data.notes) fmt::print(stderr, "{}: {}\n", a.scene, note);
  return datasets::room_of_mesh(std::move(data.mesh), data.name);
}

void check(const Arguments& a) {
  if (!(a.n >= 1) || a.n > 1e9 || a.n != std::floor(a.n))
    throw CLI::ValidationError("--n is no number of triangles");
  if (!std::isfinite(a.exposure) || !std::isfinite(a.error) ||
      (a.exposure > 0 && !std::isfinite(1 / a.exposure)))
    throw CLI::ValidationError("--exposure and --error must be numbers within range");
  for (const std::string& file : {a.exr, a.png}) {
    if (file.empty()) continue;
    const std::filesystem::path path(file), folder = path.has_parent_path() ? path.parent_path() : ".";
    if (!std::filesystem::is_directory(folder) || ::access(folder.c_str(), W_OK) != 0)
      throw CLI::ValidationError(file + ": its folder is not there or cannot be written to");
    if (std::filesystem::is_directory(path)) throw CLI::ValidationError(file + " is a folder");
  }
  for (const std::string& file : {a.exr, a.png})
    if (!file.empty() && !a.force && std::filesystem::exists(file))
      throw CLI::ValidationError(file + " exists already; --force replaces it");
  if (!a.exr.ends_with(".exr")) throw CLI::ValidationError(a.exr + ": the first file must be an .exr");
  if (!a.png.empty() && !a.png.ends_with(".png"))
    throw CLI::ValidationError(a.png + ": the second file must be a .png");
}

/// A line that is rewritten on a terminal; elsewhere one now and then.
class Told {
 public:
  ~Told() {
    if (terminal_ && shown_) fmt::print(stderr, "\r\033[K");
  }
  void tell(const std::string& line, bool last) {
    if (!terminal_ && !last && Clock::now() < next_) return;
    if (terminal_)
      fmt::print(stderr, "\r{}\033[K", line);
    else
      fmt::print(stderr, "{}\n", line);
    shown_ = true, next_ = Clock::now() + std::chrono::seconds(5);
  }

 private:
  bool terminal_ = isatty(STDERR_FILENO) != 0, shown_ = false;
  Clock::time_point next_ = Clock::now() + std::chrono::seconds(1);
};

/// Samples that share a net: enough sets of them for an estimate of the error.
int set_of(int samples) { return samples >= 64 ? 16 : samples >= 16 ? 4 : 1; }

void write(const Image& image, const std::string& file, bool force) {
  datasets::Dataset data;
  data.kind = datasets::Kind::image, data.image = image;
  datasets::write(data, file, force);
}

Image eight_bits(Image image) {
  for (float& x : image.values) x = std::floor(x * 255 + 0.5f) / 255.0f;
  return image;
}

void render(const Arguments& a, const treeline::shading::LitScene& room) {
  const int set = set_of(a.samples);
  const auto tracer = light::mis_tracer(room, a.seed, set);
  light::Film film = tracer->film();
  const auto start = Clock::now();
  const std::clock_t cpu = std::clock();
  const auto seconds = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
  const auto error = [&] {
    const double e = film.relative_error();
    return std::isfinite(e) ? fmt::format("{:.3g}", e) : std::string("not yet known");
  };
  int done = 0;
  {
    Told told;
    while (done < a.samples && !interrupted) {
      const int step = std::min(set, a.samples - done);
      tracer->add(film, step, a.threads);
      done += step;
      const double left = seconds() / done * (a.samples - done);
      told.tell(
          fmt::format("{}: {} of {} samples, {}, {} left, estimated relative error {}", a.scene, done,
                      a.samples, bench::format_seconds(seconds()), bench::format_seconds(left), error()),
          done == a.samples);
      if (a.error > 0 && film.relative_error() <= a.error) break;
    }
  }
  const Image image = film.image();
  write(image, a.exr, a.force);
  if (!a.png.empty()) {
    const float exposure = a.exposure > 0 ? static_cast<float>(a.exposure) : light::exposure_of(image);
    write(eight_bits(light::displayed(image, exposure)), a.png, a.force);
  }
  const double used = static_cast<double>(std::clock() - cpu) / CLOCKS_PER_SEC;
  fmt::print(
      "{}: {} x {} pixels, {} triangles, {} samples a pixel, {:.2f} s ({:.2f} s of processor time, "
      "{:.2f} million paths a second of it), estimated relative error {}\n",
      a.exr, film.width(), film.height(), room.mesh.size(), done, seconds(), used,
      1e-6 * film.samples() * static_cast<double>(film.size()) / std::max(used, 1e-9), error());
  if (a.error > 0 && !(film.relative_error() <= a.error)) {
    fmt::print(stderr, "{}: --error {:g} was not reached by {} samples a pixel; the estimate is {}", a.exr,
               a.error, done, error());
    if (const double times = film.relative_error() / a.error; std::isfinite(times))
      fmt::print(stderr, ". It falls with their square root: about {:.2g} would do", done * times * times);
    fmt::print(stderr, "\n");
  }
}

void render(const Arguments& a) {
  treeline::shading::LitScene room;
  try {
    room = read_room(a);
  } catch (const std::bad_alloc&) {
    throw std::runtime_error(a.scene + ": its triangles are more than memory takes");
  }
  if (a.width > 0) room.camera.width = a.width;
  if (a.height > 0) room.camera.height = a.height;
  try {
    render(a, room);
  } catch (const std::bad_alloc&) {
    // The film, its image, that as a screen shows it, and what is handed to the writer.
    constexpr std::size_t each = light::Film::bytes_per_pixel() + 3 * (3 * sizeof(float));
    const auto width = static_cast<std::size_t>(room.camera.width),
               height = static_cast<std::size_t>(room.camera.height);
    throw std::runtime_error(
        fmt::format("{} x {} pixels need {} of memory, {} bytes each, beside {} triangles; that much is not "
                    "to be had",
                    width, height, bench::format_bytes(width * height * each), each, room.mesh.size()));
  }
}

}  // namespace

int main(int argc, char** argv) {
  Arguments a;
  CLI::App app{"Path traces a room of the recipes, or a mesh under a lamp and an even sky."};
  app.add_option("scene", a.scene, "a room (treeline_gen --list), knobs included, or a file with a mesh")
      ->required();
  app.add_option("exr", a.exr, "radiance, as floats")->required();
  app.add_option("png", a.png, "as a screen shows it");
  app.add_option("--n", a.n, "about so many triangles of a room");
  app.add_option("--samples", a.samples, "paths a pixel")->check(CLI::Range(1, 1 << 24));
  app.add_option("--threads", a.threads, "the image does not depend on them")->check(CLI::Range(1, 1024));
  app.add_option("--width", a.width, "pixels")->check(CLI::Range(1, largest_side));
  app.add_option("--height", a.height, "pixels")->check(CLI::Range(1, largest_side));
  app.add_option("--seed", a.seed, "of room and paths")->check(datasets::whole_number());
  app.add_option("--error", a.error,
                 "ends when the estimated relative error is no larger, or after --samples; says so if it is")
      ->check(CLI::PositiveNumber);
  app.add_option("--exposure", a.exposure, "of the PNG: this much radiance is white")
      ->check(CLI::PositiveNumber);
  app.add_flag("--force", a.force, "replaces files");
  app.footer(
      "A file's mesh stands on a floor and is seen from outside, y up; that view is fixed.\n"
      "Exit status: 0 done, be --error reached or not; 2 unusable arguments or files.");
  std::signal(SIGINT, [](int) { interrupted = 1; });
  try {
    app.parse(argc, argv);
    check(a);
    if (a.exposure > 0) a.exposure = 1 / a.exposure;
    render(a);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  } catch (const std::exception& e) {
    fmt::print(stderr, "treeline_render: {}\n", e.what());
    return 2;
  }
  return 0;
}
