// What the pictures of this folder share: figures and colours as SVG writes them.
#pragma once

#include <cstdio>
#include <string>

namespace treeline::bench::knn {

inline std::string svg_number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f", x);
  return text;
}

/// Two digits, for prose: "3.1e+04".
inline std::string svg_figure(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2g", x);
  return text;
}

/// From light to dark as the share goes from 0 to 1: a single hue, readable without colour vision.
inline std::string svg_shade(double share) {
  const auto mix = [&](int light, int dark) {
    return std::to_string(static_cast<int>(light + share * (dark - light)));
  };
  return "rgb(" + mix(237, 33) + "," + mix(248, 102) + "," + mix(251, 172) + ")";
}

}  // namespace treeline::bench::knn
