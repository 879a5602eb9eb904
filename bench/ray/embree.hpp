// What the Embree methods share: one device and one committed scene a build, and the rules its manual asks
// for.
//
// Embree 3 and 4 differ here only in the context argument, hidden in EmbreeCall below.
// - frequency_level=simd256: on Skylake-class servers the default is simd128 (4-wide nodes), which is slower;
// on others simd256 is the default already, and without AVX2 the setting is left away.
// - FTZ and DAZ are set in the calling threads while they cast rays, and put back afterwards.
// - quality=refit is Embree's own for geometry that moves: a scene marked as dynamic, in which a commit after
// new
//   vertices refits the tree instead of building it.
// - Triangles that are not finite are filtered by Embree itself; ids stay those of the faces.
#pragma once

#if TREELINE_EMBREE_MAJOR >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif
#include <xmmintrin.h>

#include <cstring>
#include <map>
#include <string>

#include "bench/core/registry.hpp"
#include "bench/ray/method.hpp"

namespace treeline::bench::ray {

/// Sets flush-to-zero and denormals-are-zero in this thread for as long as it lives.
class FlushDenormals {
 public:
  FlushDenormals() : saved_(_mm_getcsr()) { _mm_setcsr(saved_ | 0x8040u); }
  ~FlushDenormals() { _mm_setcsr(saved_); }
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;

 private:
  unsigned saved_;
};

inline std::string embree_config(int threads) {
  std::string config = "threads=" + std::to_string(threads) + ",set_affinity=0";
  if (__builtin_cpu_supports("avx2")) config += ",frequency_level=simd256";
  return config;
}

/// Keeps a device alive for each number of threads: the first of a process maps 128 MiB for tessellated
/// surfaces, which triangles never touch, and the first scene makes TBB's pools (4 MiB); neither belongs to a
/// scene. Embree limits TBB, and so everyone in the process, to the largest number that a living device asked
/// for: a run on more threads has to tell it before anything is built.
inline void warm_up_embree(int threads) {
  static std::map<int, RTCDevice> kept;
  RTCDevice& device = kept[threads];
  if (device) return;
  device = rtcNewDevice(embree_config(threads).c_str());
  const RTCScene empty = rtcNewScene(device);
  rtcCommitScene(empty);
  rtcReleaseScene(empty);
}

inline void to_embree(const geometry::Rayf& r, RTCRay& ray) {
  ray.org_x = r.origin[0], ray.org_y = r.origin[1], ray.org_z = r.origin[2], ray.tnear = r.t_min;
  ray.dir_x = r.direction[0], ray.dir_y = r.direction[1], ray.dir_z = r.direction[2], ray.time = 0;
  ray.tfar = r.t_max, ray.mask = ~0u, ray.id = 0, ray.flags = 0;
}

class EmbreeScene {
 public:
  /// Knobs: quality (low, medium, high, refit), robust and compact (true, false).
  EmbreeScene(const geometry::Mesh3f& mesh, const Knobs& knobs, int threads) {
    warm_up_embree(threads);
    device_ = rtcNewDevice(embree_config(threads).c_str());
    if (!device_) throw std::runtime_error("Embree gave no device");
    scene_ = rtcNewScene(device_);
    const auto quality = knobs.at("quality").get<std::string>();
    refits_ = quality == "refit";
    // Only scenes of low quality keep a tree for each geometry, and only such a tree is refitted (measured:
    // in others every commit builds anew). The tree itself is one of medium quality.
    rtcSetSceneBuildQuality(scene_, refits_ ? RTC_BUILD_QUALITY_LOW : quality_of(quality));
    unsigned flags = RTC_SCENE_FLAG_NONE;
    if (knobs.value("robust", false)) flags |= RTC_SCENE_FLAG_ROBUST;
    if (knobs.value("compact", false)) flags |= RTC_SCENE_FLAG_COMPACT;
    if (refits_) flags |= RTC_SCENE_FLAG_DYNAMIC;
    rtcSetSceneFlags(scene_, static_cast<RTCSceneFlags>(flags));
    const RTCGeometry triangles = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetGeometryBuildQuality(triangles, quality_of(quality));
    if (void* vertices = rtcSetNewGeometryBuffer(triangles, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                 sizeof(geometry::Vec3f), mesh.vertices.size());
        vertices && !mesh.vertices.empty())
      std::memcpy(vertices, mesh.vertices.data(), mesh.vertices.size() * sizeof(geometry::Vec3f));
    if (void* faces = rtcSetNewGeometryBuffer(triangles, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                              sizeof(geometry::Mesh3f::Face), mesh.faces.size());
        faces && !mesh.faces.empty())
      std::memcpy(faces, mesh.faces.data(), mesh.faces.size() * sizeof(geometry::Mesh3f::Face));
    rtcCommitGeometry(triangles);
    geometry_id_ = rtcAttachGeometry(scene_, triangles);
    rtcReleaseGeometry(triangles);
    rtcCommitScene(scene_);
    if (const RTCError error = rtcGetDeviceError(device_); error != RTC_ERROR_NONE) {
      release();
      throw std::runtime_error("Embree refused the mesh, error " + std::to_string(error));
    }
  }
  ~EmbreeScene() { release(); }
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;

  /// Throws Unsupported where the scene was not built to be refitted.
  bool refit(const geometry::Mesh3f& mesh) {
    if (!refits_) throw Unsupported("not measured: Embree's refit is, in embree_single with quality=refit");
    const RTCGeometry triangles = rtcGetGeometry(scene_, geometry_id_);
    if (void* vertices = rtcGetGeometryBufferData(triangles, RTC_BUFFER_TYPE_VERTEX, 0);
        vertices && !mesh.vertices.empty())
      std::memcpy(vertices, mesh.vertices.data(), mesh.vertices.size() * sizeof(geometry::Vec3f));
    rtcUpdateGeometryBuffer(triangles, RTC_BUFFER_TYPE_VERTEX, 0);
    rtcCommitGeometry(triangles);
    rtcCommitScene(scene_);
    return true;
  }

  RTCScene scene() const { return scene_; }
  RTCDevice device() const { return device_; }

 private:
  static RTCBuildQuality quality_of(const std::string& name) {
    if (name == "low") return RTC_BUILD_QUALITY_LOW;
    if (name == "medium") return RTC_BUILD_QUALITY_MEDIUM;
    if (name == "high") return RTC_BUILD_QUALITY_HIGH;
    if (name == "refit") return RTC_BUILD_QUALITY_REFIT;
    throw std::invalid_argument("knob quality is '" + name + "'; it must be low, medium, high or refit");
  }
  void release() { rtcReleaseScene(scene_), rtcReleaseDevice(device_); }

  RTCDevice device_ = nullptr;
  RTCScene scene_ = nullptr;
  unsigned geometry_id_ = 0;
  bool refits_ = false;
};

/// The per-call argument that tells Embree whether rays are coherent.
class EmbreeCall {
 public:
  explicit EmbreeCall(bool coherent) {
#if TREELINE_EMBREE_MAJOR >= 4
    rtcInitIntersectArguments(&intersect), rtcInitOccludedArguments(&occluded);
    const RTCRayQueryFlags flags = coherent ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT;
    intersect.flags = occluded.flags = flags;
#else
    rtcInitIntersectContext(&context);
    context.flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
#endif
  }

#if TREELINE_EMBREE_MAJOR >= 4
  RTCIntersectArguments intersect;
  RTCOccludedArguments occluded;
  void operator()(RTCScene s, RTCRayHit& r) { rtcIntersect1(s, &r, &intersect); }
  void operator()(RTCScene s, RTCRay& r) { rtcOccluded1(s, &r, &occluded); }
  void operator()(const int* valid, RTCScene s, RTCRayHit8& r) { rtcIntersect8(valid, s, &r, &intersect); }
  void operator()(const int* valid, RTCScene s, RTCRay8& r) { rtcOccluded8(valid, s, &r, &occluded); }
  void operator()(const int* valid, RTCScene s, RTCRayHit16& r) { rtcIntersect16(valid, s, &r, &intersect); }
  void operator()(const int* valid, RTCScene s, RTCRay16& r) { rtcOccluded16(valid, s, &r, &occluded); }
#else
  RTCIntersectContext context;
  void operator()(RTCScene s, RTCRayHit& r) { rtcIntersect1(s, &context, &r); }
  void operator()(RTCScene s, RTCRay& r) { rtcOccluded1(s, &context, &r); }
  void operator()(const int* valid, RTCScene s, RTCRayHit8& r) { rtcIntersect8(valid, s, &context, &r); }
  void operator()(const int* valid, RTCScene s, RTCRay8& r) { rtcOccluded8(valid, s, &context, &r); }
  void operator()(const int* valid, RTCScene s, RTCRayHit16& r) { rtcIntersect16(valid, s, &context, &r); }
  void operator()(const int* valid, RTCScene s, RTCRay16& r) { rtcOccluded16(valid, s, &context, &r); }
#endif
};

/// Every build that rays may be asked of, the best first. High with robust is left out: robust silently drops
/// the spatial splits that make it high.
inline std::vector<Knobs> embree_builds() {
  std::vector<Knobs> all;
  const auto add = [&](const char* quality, bool robust) -> Knobs& {
    return all.emplace_back(Knobs{{"quality", quality}, {"robust", robust}});
  };
  add("medium", false), add("high", false), add("medium", true), add("refit", false), add("low", false);
  add("low", true), add("medium", false)["compact"] = true;
  return all;
}

/// Those for packets, whose speed is what they are about.
inline std::vector<Knobs> embree_packet_builds() {
  std::vector<Knobs> all;
  for (const char* quality : {"medium", "high", "low"})
    all.push_back(Knobs{{"quality", quality}, {"robust", false}});
  return all;
}

inline std::string embree_version() { return RTC_VERSION_STRING; }

/// A method that hands over many rays a call, and says whether they keep together. Claim: as
/// embree_single.cpp says.
template <class BatchIndex>
bool register_embree_batch(std::string name, int ladder, bool scales) {
  return Registry<Method>::instance().add(
      {.info = {.name = std::move(name),
                .family = "bvh",
                .source = Source::peer,
                .claim = Claim::approximate,
                .peer_version = embree_version(),
                .build_knobs = embree_packet_builds(),
                .query_knobs = {Knobs{{"coherent", true}}, Knobs{{"coherent", false}}},
                .ladder = ladder,
                .quick_builds = 1,
                .scales = scales},
       .build = [](const geometry::Mesh3f& mesh, const Knobs& knobs, int threads) -> std::unique_ptr<Index> {
         return std::make_unique<BatchIndex>(mesh, knobs, threads);
       },
       .warm_up = warm_up_embree});
}

}  // namespace treeline::bench::ray
