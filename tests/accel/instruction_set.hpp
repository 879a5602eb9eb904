// Whether this machine has the instructions that a file is compiled for.
#pragma once

namespace treeline::accel::test {

inline bool runs_here() {
#if TREELINE_SIMD == 512
  return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
         __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512dq");
#elif TREELINE_SIMD == 256
  return __builtin_cpu_supports("avx2");
#elif TREELINE_SIMD == 128
  return __builtin_cpu_supports("sse4.1");
#else
  return true;
#endif
}

}  // namespace treeline::accel::test
