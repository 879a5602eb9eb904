#include "bench/core/environment.hpp"

#include <unistd.h>

#include <ctime>
#include <fstream>

#include "treeline_commit.hpp"

namespace treeline::bench {
namespace {

// The widest instruction set this program was compiled for; the flags below say how it was asked for.
constexpr const char* isa =
#if defined(__AVX512F__)
    "avx512";
#elif defined(__AVX2__)
    "avx2";
#elif defined(__AVX__)
    "avx";
#elif defined(__SSE4_2__)
    "sse4.2";
#elif defined(__SSE2__)
    "sse2";
#else
    "generic";
#endif

constexpr const char* compiler =
#if defined(__clang__)
    "clang++ " __clang_version__;
#else
    "g++ " __VERSION__;
#endif

std::string cpu_model() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.starts_with("model name")) return line.substr(std::min(line.find(':') + 2, line.size()));
  return "unknown";
}

std::string host_name() {
  char name[256] = "";
  return gethostname(name, sizeof name - 1) == 0 ? name : "unknown";
}

}  // namespace

const nlohmann::ordered_json& environment() {
  static const nlohmann::ordered_json made{{"isa", isa},           {"flags", TREELINE_FLAGS},
                                           {"compiler", compiler}, {"cpu", cpu_model()},
                                           {"host", host_name()},  {"commit", TREELINE_COMMIT}};
  return made;
}

std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

}  // namespace treeline::bench
