#include "bench/ray/pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "accel/bvh.hpp"
#include "bench/ray/album.hpp"
#include "bench/ray/block.hpp"
#include "bench/ray/judge.hpp"
#include "bench/ray/queries.hpp"
#include "bench/ray/slice_svg.hpp"
#include "bench/ray/work_picture.hpp"
#include "geometry/tolerances.hpp"

namespace treeline::bench::ray {
namespace {

using geometry::Rayf;
using geometry::Vec3d;
using shading::Image;

constexpr int width = 480, height = 360;
constexpr std::array<double, 3> background{0.10, 0.11, 0.13};
constexpr std::array<double, 3> false_colour{1.0, 0.0, 0.9}, borderline_colour{1.0, 0.75, 0.0},
    aimed_colour{0.1, 0.55, 0.3};

/// A mesh seen by the camera, with the true hit of each pixel.
struct View {
  const geometry::Mesh3f& mesh;
  std::vector<Rayf> rays;
  std::vector<TrueHit> truth;
};

/// Hits of a tree over doubles.
std::vector<TrueHit> exact_by_tree(const geometry::Mesh3f& mesh, std::span<const Rayf> rays_in, int threads) {
  geometry::Mesh3d wide;
  wide.faces = mesh.faces;
  for (const auto& v : mesh.vertices) wide.vertices.push_back(Vec3d(v));
  using Tree = accel::Bvh<accel::Triangles<double>>;
  Tree::Options options;
  options.non_finite = accel::NonFinite::drop;
  const Tree tree(wide, options);
  std::vector<geometry::Rayd> rays;
  for (const Rayf& r : rays_in) rays.push_back({Vec3d(r.origin), Vec3d(r.direction)});
  std::vector<accel::Hit<double>> hits(rays.size());
  tree.closest_hit(rays, hits, threads);
  std::vector<TrueHit> truth;
  for (const auto& hit : hits) truth.push_back({hit.t, hit.primitive});
  return truth;
}

/// The truth of a picture has too many rays for brute force: a tree over doubles answers, and brute force
/// must agree with it on a sample of pixels.
View look_at(const geometry::Mesh3f& mesh, int threads) {
  View view{mesh, {}, {}};
  const Camera camera = frame(mesh, double(width) / height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) view.rays.push_back(camera.ray((x + 0.5) / width, (y + 0.5) / height));

  view.truth = exact_by_tree(mesh, view.rays, threads);
  const std::size_t samples =
      std::clamp<std::size_t>(50'000'000 / std::max<std::size_t>(mesh.size(), 1), 16, 512);
  std::vector<Rayf> sample;
  std::vector<std::size_t> pixels;
  for (std::size_t i = 0; i < samples; ++i) pixels.push_back((2 * i + 1) * view.rays.size() / (2 * samples));
  for (const std::size_t p : pixels) sample.push_back(view.rays[p]);
  const auto witness = true_closest(mesh, sample, threads);
  for (std::size_t i = 0; i < samples; ++i) {
    const TrueHit& seen = view.truth[pixels[i]];
    const double tolerance = 1e-9 * std::max(1.0, witness[i].t);
    if (static_cast<bool>(seen) != static_cast<bool>(witness[i]) ||
        (seen && std::abs(seen.t - witness[i].t) > tolerance))
      throw std::logic_error("the picture's truth disagrees with brute force at pixel " +
                             std::to_string(pixels[i]));
  }
  return view;
}

void set(Image& image, std::size_t pixel, const std::array<double, 3>& colour) {
  for (std::size_t c = 0; c < 3; ++c) image.values[3 * pixel + c] = static_cast<float>(colour[c]);
}

/// Normals as colours, darker the more the surface turns away.
Image normals(const View& view, bool grey) {
  Image image(width, height, 3);
  for (std::size_t p = 0; p < view.rays.size(); ++p) {
    set(image, p, background);
    if (!view.truth[p]) continue;
    Vec3d n =
        geometry::normalized(geometry::Triangle3d(view.mesh.triangle(view.truth[p].primitive)).area_normal());
    const double facing = geometry::dot(n, geometry::normalized(Vec3d(view.rays[p].direction)));
    if (facing > 0) n = -n;
    const double light = 0.35 + 0.65 * std::abs(facing);
    if (grey)
      set(image, p, {0.7 * light, 0.7 * light, 0.7 * light});
    else
      set(image, p, {light * (0.5 + 0.5 * n[0]), light * (0.5 + 0.5 * n[1]), light * (0.5 + 0.5 * n[2])});
  }
  return image;
}

Image depths(const View& view) {
  double near = std::numeric_limits<double>::infinity(), far = 0;
  for (const TrueHit& hit : view.truth)
    if (hit) near = std::min(near, hit.t), far = std::max(far, hit.t);
  Image image(width, height, 3);
  for (std::size_t p = 0; p < view.truth.size(); ++p) {
    set(image, p, background);
    if (!view.truth[p]) continue;
    const double nearness = far > near ? (far - view.truth[p].t) / (far - near) : 1;
    const double shade = 0.2 + 0.8 * nearness;
    set(image, p, {shade, shade, shade});
  }
  return image;
}

/// A pixel is hard to see: a plus of five marks it.
void mark(Image& image, std::size_t pixel, const std::array<double, 3>& colour) {
  const int x = static_cast<int>(pixel) % width, y = static_cast<int>(pixel) / width;
  for (const auto& [dx, dy] : {std::pair(0, 0), {1, 0}, {-1, 0}, {0, 1}, {0, -1}})
    if (x + dx >= 0 && x + dx < width && y + dy >= 0 && y + dy < height)
      set(image, static_cast<std::size_t>((y + dy) * width + x + dx), colour);
}

/// Methods that share a picture: their wrong pixels are laid over each other.
struct Group {
  std::string name, title;
  bool (*contains)(const MethodInfo&);
};

const std::array<Group, 5> groups{{
    {"ours_watertight", "our trees, watertight",
     [](const MethodInfo& i) { return i.source == Source::ours && i.claim == Claim::bounded; }},
    {"ours_moller_trumbore", "our trees, Möller–Trumbore",
     [](const MethodInfo& i) { return i.source == Source::ours && i.claim == Claim::approximate; }},
    {"ours_exact", "our trees, exact",
     [](const MethodInfo& i) { return i.source == Source::ours && i.claim == Claim::exact; }},
    {"embree", "Embree, single rays and packets",
     [](const MethodInfo& i) { return i.name.starts_with("embree"); }},
    {"cgal", "CGAL's AABB tree", [](const MethodInfo& i) { return i.name.starts_with("cgal"); }},
}};

/// The first build of each method that falls into the group.
void draw_disagreement(const Group& group, const std::vector<Method>& methods, const View& view,
                       const std::string& of, int threads, Album& album) {
  Image image = normals(view, true);
  Judge judge(view.mesh, geometry::tolerance::unit_roundoff<float>);
  std::vector<Verdict> worst(view.rays.size(), Verdict::right);
  std::string names;
  for (const Method& method : methods) {
    if (view.mesh.size() > method.info.largest_n) continue;
    if (!group.contains(method.info)) continue;
    std::vector<RayAnswer> answers(view.rays.size());
    try {
      method.build(view.mesh, method.info.build_knobs.front(), threads)
          ->closest(view.rays, answers, method.info.query_knobs.front(), threads);
    } catch (const Unsupported&) {
      continue;
    }
    names += (names.empty() ? "" : ", ") + method.info.name;
    for (std::size_t p = 0; p < answers.size(); ++p) {
      const Verdict v = judge.closest(p, view.rays[p], view.truth[p], answers[p]).verdict;
      if (v != Verdict::right && (worst[p] == Verdict::right || v != Verdict::borderline)) worst[p] = v;
    }
  }
  if (names.empty()) return;
  const auto borderline = std::ranges::count(worst, Verdict::borderline);
  const auto wrong = std::ranges::count_if(worst, [](Verdict v) { return v > Verdict::borderline; });
  for (std::size_t p = 0; p < worst.size(); ++p)
    if (worst[p] == Verdict::borderline) mark(image, p, borderline_colour);
  for (std::size_t p = 0; p < worst.size(); ++p)
    if (worst[p] > Verdict::borderline) mark(image, p, false_colour);
  album.add(
      "disagreement_" + group.name, image,
      {of + ": " + group.title + " (" + names + "): of " + std::to_string(worst.size()) + " pixels " +
           std::to_string(wrong) + " false (magenta), " + std::to_string(borderline) + " borderline (amber)",
       "", names, "disagreement"});
}

/// What each pixel costs our scalar trees, in the order KD, BSP, BVH, side by side in one scale.
void draw_work(const std::vector<Method>& methods, const View& view, const std::string& of, int threads,
               Album& album) {
  std::vector<std::vector<accel::Work>> work;
  std::string names, means;
  std::vector<std::string> labels;
  for (const char* name : {"kd_tree", "bsp_tree", "bvh", "bvh_wide"}) {
    const auto method = std::ranges::find(methods, name, [](const Method& m) { return m.info.name; });
    if (method == methods.end() || view.mesh.size() > method->info.largest_n) continue;
    const auto index = method->build(view.mesh, method->info.build_knobs.front(), threads);
    auto found = index->work_of_each(view.rays);
    if (found.empty()) continue;
    double nodes = 0, triangles = 0;
    for (const accel::Work& w : found)
      nodes += static_cast<double>(w.nodes), triangles += static_cast<double>(w.primitives);
    const auto mean = [&](double sum) {
      return fmt::format("{:.1f}", sum / static_cast<double>(found.size()));
    };
    names += (names.empty() ? "" : ", ") + method->info.name;
    means += (means.empty() ? "" : "; ") + method->info.name + " " + mean(nodes) + " nodes and " +
             mean(triangles) + " triangles";
    labels.push_back(method->info.name);
    work.push_back(std::move(found));
  }
  if (work.empty()) return;
  const double most = common_scale(work);
  std::vector<Image> panels;
  for (const auto& w : work) panels.push_back(heat_map(w, width, height, most));
  const auto count = static_cast<int>(panels.size());
  album.add("work", beside(panels, count),
            {of + ": nodes and triangles that each pixel's ray visits, black none, white " +
                 fmt::format("{:.0f}", most) + " and more; from left to right, on average: " + means,
             "", names, "work", count, labels});
}

/// Vertices and points of edges of the faces that the camera sees, and the rays to them, as exactly as float
/// can aim.
struct Aims {
  std::vector<Rayf> rays;
  std::vector<std::size_t> pixels;
};
constexpr std::size_t most_aims = 6000;

Aims aim_at_edges(const View& view) {
  std::vector<accel::Id> faces;
  for (const TrueHit& hit : view.truth)
    if (hit) faces.push_back(hit.primitive);
  std::ranges::sort(faces);
  faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
  const Camera camera = frame(view.mesh, double(width) / height);
  const Vec3d eye(geometry::Vec3f(camera.origin));
  Aims aims;
  const std::size_t step = faces.size() * 6 / most_aims + 1;
  for (std::size_t f = 0; f < faces.size(); f += step) {
    const geometry::Triangle3d t(view.mesh.triangle(faces[f]));
    for (const Vec3d& target :
         {t.a, t.b, t.c, (t.a + t.b) * 0.5, t.b * 0.3 + t.c * 0.7, t.c * 0.6 + t.a * 0.4}) {
      const Vec3d way = target - eye;
      const double depth = geometry::dot(way, camera.forward);
      const double x = 0.5 + 0.5 * geometry::dot(way, camera.right) / depth / camera.half_width;
      const double y = 0.5 - 0.5 * geometry::dot(way, camera.up) / depth / camera.half_height;
      if (!(x >= 0 && x < 1 && y >= 0 && y < 1)) continue;
      aims.rays.push_back({geometry::Vec3f(camera.origin), geometry::Vec3f(way)});
      aims.pixels.push_back(static_cast<std::size_t>(y * height) * width +
                            static_cast<std::size_t>(x * width));
    }
  }
  return aims;
}

/// Where rays aimed at edges and vertices of a closed mesh pass through it, one panel a method and build.
void draw_leaks(const std::vector<Method>& methods, const View& view, const std::string& of, int threads,
                Album& album) {
  struct Panel {
    const char *method, *words;
    Knobs knobs;  // of the build; empty: the first
  };
  const std::array<Panel, 4> wanted{
      {{"bvh_wide", "bvh_wide", {}},
       {"bvh_fast", "bvh_fast", {}},
       {"embree_single", "Embree", {{"quality", "medium"}, {"robust", false}}},
       {"embree_single", "Embree, robust", {{"quality", "medium"}, {"robust", true}}}}};
  const Aims aims = aim_at_edges(view);
  if (aims.rays.empty()) return;
  const auto truth = exact_by_tree(view.mesh, aims.rays, threads);
  Judge judge(view.mesh, geometry::tolerance::unit_roundoff<float>);
  std::vector<Image> panels;
  std::string names, counts;
  std::vector<std::string> labels;
  for (const Panel& panel : wanted) {
    const auto method = std::ranges::find(methods, panel.method, [](const Method& m) { return m.info.name; });
    if (method == methods.end()) continue;
    std::vector<RayAnswer> answers(aims.rays.size());
    method->build(view.mesh, panel.knobs.empty() ? method->info.build_knobs.front() : panel.knobs, threads)
        ->closest(aims.rays, answers, method->info.query_knobs.front(), threads);
    Image image = normals(view, true);
    std::vector<std::size_t> leaks;
    for (std::size_t i = 0; i < answers.size(); ++i) {
      const bool leaked = judge.closest(i, aims.rays[i], truth[i], answers[i]).verdict == Verdict::false_miss;
      if (leaked)
        leaks.push_back(aims.pixels[i]);
      else
        set(image, aims.pixels[i], aimed_colour);
    }
    for (const std::size_t pixel : leaks) mark(image, pixel, false_colour);
    panels.push_back(std::move(image));
    labels.push_back(fmt::format("{} {}", panel.words, leaks.size()));
    names += (names.empty() ? "" : ", ") + std::string(panel.words);
    counts += (counts.empty() ? "" : "; ") + std::string(panel.words) + " " + std::to_string(leaks.size());
  }
  if (panels.empty()) return;
  album.add(
      "leaks", beside(panels, 2),
      {of + ": " + std::to_string(aims.rays.size()) +
           " rays aimed at edges and vertices (green), and where they leak (magenta); row by row: " + counts,
       "", names, "leaks", std::min(2, static_cast<int>(panels.size())), labels});
}

/// Trees of a few thousand triangles have cells that can be told apart.
constexpr std::size_t largest_sliced = 3000;

void draw_slices(const std::vector<Method>& methods, const BlockSpec& spec, const RunContext& context,
                 Album& album) {
  const auto dataset = datasets::generate(spec.dataset, std::min(spec.n, largest_sliced), context.seed);
  const auto box = dataset.mesh.box();
  const auto sides = box.extent();
  // Square to the shortest side: of a house on its ground that is a plan, the other cuts are hardly a line.
  const int axis = static_cast<int>(std::min_element(&sides[0], &sides[0] + 3) - &sides[0]);
  for (const Method& method : methods) {
    if (method.info.source != Source::ours || method.info.family == "brute") continue;
    if (method.info.hard_cases_only) continue;
    if (method.info.claim != Claim::bounded) continue;  // the same tree with another test at its leaves
    const auto index = method.build(dataset.mesh, method.info.build_knobs.front(), context.threads);
    const auto cells = index->slice(axis, double(box.centre()[axis]));
    if (cells.empty()) continue;
    const std::string what = "slice_" + method.info.name + ".svg";
    write_slice_svg(album.path_of(what), cells);
    album.add_file(what, {method.info.name + " over " + std::to_string(dataset.size()) + " triangles of " +
                              spec.dataset + ", cut through the middle square to " + "xyz"[axis] + ": " +
                              std::to_string(cells.size()) + " leaves, darker where deeper",
                          "", method.info.name, "slice"});
  }
}

}  // namespace

void draw_pictures(const std::vector<Method>& methods, const BlockSpec& spec, const RunContext& context,
                   const std::string& folder) {
  if (spec.hard) return;
  Album album("ray", spec.dataset, folder);
  const auto dataset = datasets::generate(spec.dataset, spec.n, context.seed);
  const View view = look_at(dataset.mesh, context.threads);
  const std::string of = spec.dataset + ", " + std::to_string(dataset.size()) + " triangles";
  album.add("normals", normals(view, false), {of + ": normals", "", "bvh", "normals"});
  album.add("depth", depths(view), {of + ": depth, near is light", "", "bvh", "depth"});
  for (const Group& group : groups) draw_disagreement(group, methods, view, of, context.threads, album);
  draw_work(methods, view, of, context.threads, album);
  if (dataset.closed) draw_leaks(methods, view, of, context.threads, album);
  draw_slices(methods, spec, context, album);
}

}  // namespace treeline::bench::ray
