// What every row says of the build and the machine it comes from.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace treeline::bench {

/// isa, flags, compiler, cpu, host, commit: the same for a whole run.
const nlohmann::ordered_json& environment();

/// Now, as 2025-01-31T12:00:00Z.
std::string utc_now();

}  // namespace treeline::bench
