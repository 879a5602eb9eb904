// What a user of the installed headers writes: a nearest neighbour and a ray.
#include <accel/bvh.hpp>
#include <accel/kd_tree.hpp>
#include <shading/image.hpp>

using namespace treeline;

int main() {
  const std::vector<geometry::Vec3f> points{{0, 0, 0}, {1, 0, 0}, {0, 2, 0}};
  const accel::KdTree<accel::Points<float, 3>> tree(points);
  accel::Neighbor<float> nearest[1];
  tree.nearest({0.9f, 0.1f, 0}, 1, nearest);

  const std::vector<geometry::Triangle3f> triangles{{{0, 0, 2}, {4, 0, 2}, {0, 4, 2}}};
  const accel::Bvh<accel::Triangles<>> bvh(triangles);
  const accel::Hit<float> hit = bvh.closest_hit({{1, 1, 0}, {0, 0, 1}});
  return nearest[0].id == 1 && hit.primitive == 0 && hit.t == 2 ? 0 : 1;
}
