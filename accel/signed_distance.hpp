// Signed distance to a mesh, and whether points lie inside: a tree, and a rule for the sign.
//
//   SignedDistance<Bvh<Triangles<float>, Wide>> body(mesh);           // FirstHit: the default, exact
//   SignedDistance<KdTree<Triangles<float>>, Pseudonormal> other(mesh);
//   body.inside(point); body.signed_distance(point); body.signed_distance(points, out, threads);
//
// Which rule for which mesh (bench/inside measures it):
//   FirstHit      closed, oriented, not crossing itself: exact over the wide tree, and the fastest
//   RayParity     closed, orientation wrong in places or everywhere: exact over the wide tree
//   Pseudonormal  closed and oriented; as a by-product of the closest point
//   Winding       with holes, doubled or missing faces, shells that face the same way, soups
// A mesh is a closed set: points on it are inside. Every rule answers for every mesh; closed() and oriented()
// tell whether the answers can be relied on.
#pragma once

#include "accel/signed_distance/first_hit.hpp"
#include "accel/signed_distance/pseudonormal.hpp"
#include "accel/signed_distance/ray_parity.hpp"
#include "accel/signed_distance/signed_distance.hpp"
#include "accel/signed_distance/winding.hpp"
