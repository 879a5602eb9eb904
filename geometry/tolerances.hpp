// Every tolerance of the project, named, relative to a scale, with its derivation.
#pragma once

#include <limits>

namespace treeline::geometry::tolerance {

/// Unit roundoff: half an ulp of 1, relative error of one rounded operation.
template <class T>
inline constexpr T unit_roundoff = std::numeric_limits<T>::epsilon() / T(2);

/// Bound gamma(n) = n·u / (1 - n·u) on the relative error of n chained roundings (Higham 2002, lemma 3.1).
template <class T>
constexpr T gamma(int n) {
  return (n * unit_roundoff<T>) / (T(1) - n * unit_roundoff<T>);
}

/// Padding of a box in a slab test, relative to the distance of its corners from the ray's origin: 8
/// roundings, 6 of them used up; the derivation is in intersect_box.hpp.
template <class T>
inline constexpr T slab_padding = T(8) * unit_roundoff<T>;

/// Slack of a point's distance bound from a plane of computed unit normal, relative to the coordinates'
/// distance from the local origin: 1 rounding to shift and D to project for each of the two points, D + 4 for
/// the length of the normal, (D + 2) / 2 for the compared distance, and the bound's own; 2 D + 8 covers
/// either sum.
template <class T>
constexpr T plane_bound(int dimension) {
  return gamma<T>(2 * dimension + 8);
}

/// Slack of a point's distance bound from a ball, relative: the computed distance of the ball's centre and
/// its radius are off by D + 2 roundings of a squared distance and D of squares that lose digits to
/// underflow, both halved by the root, 1 of the root and 2 to apply the slack, and must not be by more; the
/// bound itself by 3 more and half of one to square, and the distance compared by D + 1. D + 6 covers the
/// larger sum.
template <class T>
constexpr T ball_bound(int dimension) {
  return gamma<T>(dimension + 6);
}

/// Slack of a bound summed over columns, relative: a row's squared distance takes at most columns + 8
/// roundings from the differences (each of which counts twice, by its square), the bound's start as many, and
/// each of up to 48 levels adds 4; (1 + epsilon)² and the comparison take the rest.
template <class T>
constexpr T row_bound(int columns) {
  return gamma<T>(3 * columns + 256);
}

/// How far a hit's point on the ray may be from its point on the triangle, along each axis, relative to the
/// reach: the largest distance along an axis from the ray's origin to a corner of the triangle. The ray tests
/// themselves displace a triangle by up to 16 u of the reach (slab_padding along two axes); computing the two
/// points takes 3 roundings of the weights, 5 of the triangle's point and 2 of the ray's. 32 covers the sum.
template <class T>
inline constexpr T hit_slack = T(32) * unit_roundoff<T>;

/// Slack of a plane crossing in a tree's traversal, relative to the reach of the triangles behind it:
/// hit_slack, and 4 roundings of the crossing, doubled. The reach is at most the sum of two distances: the
/// ray's origin from the tree's centre, for which the ray brings its share of the slack, and the triangles'
/// corners from that centre, for which planes and boxes are stored widened (stored_slack).
template <class T>
inline constexpr T plane_slack = hit_slack<T> + T(8) * unit_roundoff<T>;

/// How far an edge's computed crossing with a plane may be from the true one, along each axis, relative to
/// the triangle's largest coordinate there: 4 roundings of the parameter and 2 of the product with an edge up
/// to twice as long, 1 of the sum; 16 covers the 13.
template <class T>
inline constexpr T crossing_slack = T(16) * unit_roundoff<T>;

/// Distance within which a corner counts as on an oblique plane, relative to the corner's largest distance
/// along an axis from the tree's centre: 3 roundings of the plane's own corners, 5 of the normal, 4 of the
/// distance, each of lengths up to sqrt(3) times that, and room to find triangles of one flat wall on one
/// plane.
template <class T>
inline constexpr T on_plane = T(28) * unit_roundoff<T>;

/// Slack of a ray's distance from an oblique plane, relative to the reach as above: on_plane, sqrt(3)
/// hit_slack = 56 u, 12 u for the origin's distance, 12 u for the travelled one, 5 u to divide, 64 u for the
/// corners of cut triangles (clip_slack; double alone); 192 covers the sum.
template <class T>
inline constexpr T oblique_slack = T(192) * unit_roundoff<T>;

/// Slack of a bound on the distance to a closest point, relative to the largest coordinate involved: 4
/// roundings to find the point, along each of three axes (12 sqrt(3) = 21), and 7 of a plane's distance, over
/// lengths of up to twice a box's diagonal half (24); 64 covers the sum.
template <class T>
inline constexpr T closest_slack = T(64) * unit_roundoff<T>;

/// How far a sample of a distance field may be off, relative to the largest coordinate involved:
/// closest_slack for the choice of the triangle; 2 roundings of the sample's place along each axis (4 sqrt(3)
/// = 7) where it decides the side; 1 to store the distance, which is at most twice sqrt(3) times the largest
/// coordinate (4). 80 covers the sum.
template <class T>
inline constexpr T sample_slack = T(80) * unit_roundoff<T>;

/// Slack of clipping a triangle to a box in double, relative to its largest coordinate: a cut takes 5
/// roundings of lengths up to twice that, and adds its error to that of the cuts before; 6 cuts.
inline constexpr double clip_slack = 64 * unit_roundoff<double>;

/// What a tree widens the axis planes and boxes by that it stores, relative to the largest distance along an
/// axis from its centre to a corner of the triangles behind them: the larger of plane_slack and
/// closest_slack.
template <class T>
inline constexpr T stored_slack = closest_slack<T>;

/// A hit whose barycentric coordinates and cosine of incidence all exceed this tells for certain on which
/// side of the triangle the ray came from: half the digits.
template <class T>
inline constexpr T clear_hit = std::numeric_limits<T>::digits < 30 ? T(2.5e-4) : T(1e-8);

/// What a depth map's comparison allows for rounding, as a share of the depth range and of a filter's reach
/// over the receiver's plane: 1 rounding to store either depth, 2 to apply the bias, 4 to follow the plane;
/// float, whatever the scene's type.
inline constexpr double shadow_depth_slack = 8 * unit_roundoff<float>;

/// A point this near to a surface, relative to the largest coordinate involved, is on it: what the corners'
/// own rounding to T leaves open, four times.
template <class T>
inline constexpr T on_surface = T(4) * unit_roundoff<T>;

/// How far off its surface a shadow ray starts, relative to the reach of its scene (the camera's place
/// included). A hit that a ray test reports lies, along each axis, within hit_slack of its triangle: if the
/// ray starts farther above the triangle's plane than sqrt(3) of those and goes away from it, it cannot
/// report that triangle. The same once more for the receiver, which a ray from the camera found; 111 u.
/// Rounding origin and direction takes the rest, where the scene is no farther from its coordinates' origin
/// than it is large.
template <class T>
inline constexpr T shadow_offset = T(128) * unit_roundoff<T>;

/// How far the sum over a box may be off by a table of running sums, relative to the sum of all absolute
/// values and for each row and column of the table: an entry is as many additions deep, and a box takes four.
template <class T>
inline constexpr T table_slack = T(4) * unit_roundoff<T>;

/// How far a value may be from its level, in steps: half a step, and what float rounds in finding it.
inline constexpr double level_slack = 0.52;

}  // namespace treeline::geometry::tolerance
