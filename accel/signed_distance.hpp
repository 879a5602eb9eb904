// Signed distance to a mesh, and whether points lie inside: a tree, and a rule for the sign.
//
//   SignedDistance<Bvh<Triangles<float>, Wide>> body(mesh);           // FirstHit: the default, exact
//   SignedDistance<KdTree<Triangles<float>>, Pseudonormal> other(mesh);
//   body.inside(point); body.signed_distance(point); body.signed_distance(points, out, threads);
//
// Which rule for which mesh (bench/inside measures it):
//   FirstHit      closed, oriented, not crossing itself: exact over the wide tree, and the fastest
//   RayParity     closed, orientation wrong in places or everywhere: exact over the wide tree
//   Pseudonormal  closed and oriented, no two faces in one place; as a by-product of the closest point
//   Winding       with holes, doubled or missing faces, shells that face the same way, soups
// "Exact" means the sign, for the triangles that the tree keeps: in meshes of mixed scale far from 1 those
// below 2^-149 of the typical coordinate vanish (triangle_scale.hpp). Distances are rounded as the tree's.
// A mesh is a closed set: points on its faces are inside; on faces without area, which no rule but
// Pseudonormal looks at, only where a face with area passes too. Every rule answers for every mesh; closed()
// and oriented() tell whether it is closed and oriented, but not whether it crosses or touches itself.
#pragma once

#include "accel/signed_distance/first_hit.hpp"
#include "accel/signed_distance/pseudonormal.hpp"
#include "accel/signed_distance/ray_parity.hpp"
#include "accel/signed_distance/signed_distance.hpp"
#include "accel/signed_distance/winding.hpp"
