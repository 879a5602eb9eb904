#include "datasets_gen/files/pcl_pcd.hpp"

#include <pcl/PCLPointCloud2.h>
#include <pcl/console/print.h>
#include <pcl/io/pcd_io.h>

#include <cstring>
#include <exception>
#include <sstream>

namespace treeline::datasets::files {

std::string pcl_read_pcd(const std::string& header, std::string_view body, std::vector<double>& xyz) try {
  pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);  // nothing: it prints to the terminal otherwise
  pcl::PCLPointCloud2 cloud;
  pcl::PCDReader reader;
  Eigen::Vector4f origin;
  Eigen::Quaternionf orientation;
  int version = 0, kind = 0;  // of the data: text, binary, compressed
  unsigned body_at = 0;
  std::istringstream head(header);
  if (reader.readHeader(head, cloud, origin, orientation, version, kind, body_at) < 0)
    return "PCL cannot read its header, though it is sound";
  int result = 0;
  if (kind == 0) {
    std::istringstream text{std::string(body)};
    result = reader.readBodyASCII(text, cloud, version);
  } else {
    const auto* data = reinterpret_cast<const unsigned char*>(body.data());
    result = reader.readBodyBinary(data, cloud, version, kind == 2, 0);
  }
  if (result < 0) return "PCL cannot read it, though its header is sound";
  const std::size_t n = static_cast<std::size_t>(cloud.width) * cloud.height;
  if (cloud.data.size() < n * cloud.point_step) return "PCL read fewer points than the header promises";

  const pcl::PCLPointField* axis[3] = {};
  for (const auto& field : cloud.fields)
    for (int k = 0; k < 3; ++k)
      if (field.name == std::string(1, static_cast<char>('x' + k))) axis[k] = &field;
  for (const auto* field : axis)
    if (field == nullptr ||
        (field->datatype != pcl::PCLPointField::FLOAT32 && field->datatype != pcl::PCLPointField::FLOAT64))
      return "PCL finds no fields x, y, z of type float or double";
  xyz.reserve(xyz.size() + 3 * n);
  for (std::size_t i = 0; i < n; ++i)
    for (const auto* field : axis) {
      const auto* at = cloud.data.data() + i * cloud.point_step + field->offset;
      if (field->datatype == pcl::PCLPointField::FLOAT32) {
        float v;
        std::memcpy(&v, at, sizeof v);
        xyz.push_back(v);
      } else {
        double v;
        std::memcpy(&v, at, sizeof v);
        xyz.push_back(v);
      }
    }
  return {};
} catch (const std::exception& e) {
  return std::string("PCL cannot read it: ") + e.what();
}

}  // namespace treeline::datasets::files
