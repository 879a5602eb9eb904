"""What the report says about each task: titles, units and how its error is meant. An unknown task gets plain words."""

from dataclasses import dataclass


@dataclass(frozen=True)
class TaskText:
    title: str
    question: str
    element: str  # what a dataset is made of
    query: str
    error: str  # name of the primary metric, as an axis title
    meaning: str = ""  # of that metric
    query_sets: tuple = ()  # (name, what is asked)
    hard: str = ""  # why some methods have no hard cases
    methods: tuple = ()  # (names, what they do), where a name does not say it
    errors: tuple = ()  # (query set, name of its error), of sets whose error is another than the task's
    mean: bool = True  # the error is the mean over queries; else `meaning` says what it is

    def error_of(self, query_set):
        return dict(self.errors).get(query_set, self.error)


TASKS = {
    "brdf_integral": TaskText(
        "Light reflected by surfaces",
        "How much of the light from all around does a surface reflect to a viewer?",
        "direction", "query", "relative RMS error",
        "The root mean square of what an answer is off, over the mean of the true ones; of furnace and fresnel the share of the light, "
        "of evaluate the relative error. A surface of one direction is asked for integrals; one of thousands, for its values and "
        "samples at so many at a time. Stochastic methods promise no bias: the mean of their answers within five standard errors.",
        (("albedo", "the light reflected under a sky of 1, by viewers at all angles"),
         ("cosine_sky", "the same under a sky as bright as the cosine of the angle to the normal"),
         ("small_light", "a disc of 10 degrees across, seen from about the mirror's side"),
         ("average", "under a sky of 1, over all viewers"),
         ("evaluate", "the values of the BRDF for pairs of directions, half of them where the surface gleams"),
         ("sample", "directions for a viewer, and their weight"),
         ("white_…, colour_…", "how much rough metal reflects with all bounces: its roughness, and what facets reflect head-on"),
         ("index_…, leaving_…, names of metals", "how much a smooth boundary reflects, from 0 to 90 degrees"),
         ("sphere_…, disc_…, triangle_…, rectangle_…, box_…", "how large shapes are seen, by distance in radii"),
         ("hemisphere, all_around", "a disc that touches the viewer, and a box around")),
        methods=(
         ("facets", "sampled are the facets' normals, by their distribution alone"),
         ("visible_2018, visible_caps", "normals of those facets that the viewer sees, on a disc that is warped (Heitz 2018) or by "
          "caps of a sphere (Dupuy and Benyoub 2023)"),
         ("own", "the sampler that the surface's material brings"),
         ("light, mis", "directions to the light, and both ways weighted by the power heuristic"),
         ("quadrature, quadrature_facets, unmasked", "integrals over directions, over facets, and over facets without shadowing and masking")),
        mean=False),
    "distance_field": TaskText(
        "Distance fields of meshes",
        "How far is it to the surface, on which side, and what does a ray meet, if only samples of the distance are kept?",
        "triangle", "query", "mean error in longest sides",
        "How far a distance is off, in lengths of the longest side of the mesh's box; for uniform, the share of wrong sides; "
        "for trace, how far off the hit is, where a false hit or a false miss counts 1. Fields know distances in a band of 3 "
        "cells on either side of the surface, and claim bounds of their own, which their resolution sets; the tree over the mesh "
        "is off by rounding alone.",
        (("near", "points within 1 % of the longest side from the surface"),
         ("uniform", "points of the mesh's box and a tenth around it"),
         ("trace", "where rays from all around first meet the surface")),
        errors=(("uniform", "share of wrong sides"),)),
    "inside": TaskText(
        "Points in meshes",
        "Is a point inside a mesh?",
        "triangle", "query", "share of wrong answers",
        "Points on the surface belong to the mesh, and only methods that claim to be exact must say so. A damaged mesh "
        "(its name says how, after the plus) is held against what was inside of it before: there nobody promises anything.",
        (("near", "a thousandth of the diagonal off a random point of the surface, in random order"),
         ("near_sorted, uniform_sorted", "the same queries, each near the one before: our trees put a batch in order by "
          "themselves, peers are asked one point after the other"),
         ("uniform", "anywhere in the mesh's box"),
         ("far", "two to four diagonals away"),
         ("centre", "in the middle of the box"),
         ("on_vertex", "two coordinates are those of a vertex, so that rays along an axis meet it"),
         ("near_threads, uniform_threads", "the same as those without _threads, more queries, for thread scaling")),
        methods=(
         ("bvh_pseudonormal, wide_pseudonormal", "the side of the closest point, by angle-weighted normals of faces, edges and corners, "
          "over a hierarchy of two children or of many; wide_face_normal: by the plane of the face found alone"),
         ("…_first_hit, …_parity", "by the side of the first face that a ray meets, or by how many it meets"))),
    "knn": TaskText(
        "Neighbours in point clouds",
        "Which points lie nearest to a query, within a radius of it, or inside a box?",
        "point", "query", "mean relative error",
        "The relative excess of a distance found over the true one, the worst of the k; a neighbour that is missing or "
        "does not exist counts 1. For radius and box: the share of points missing or surplus. A cloud that single precision "
        "cannot hold (georeferenced) is asked and judged in doubles: methods called …_rounded make floats of it, at once "
        "(origin file) or less the middle of the cloud (origin middle).",
        (("knn1_self, knn8_self, knn32_self, knn100_self",
          "the 1, 8, 32 or 100 nearest of a point of the cloud, itself included, in random order"),
         ("knn8_sorted", "the queries of knn8_self, each near the one before"),
         ("knn1_off, knn8_off, knn32_off", "the 1, 8 or 32 nearest of a position anywhere in the cloud's box"),
         ("knn8_far", "the 8 nearest of a position two to four diagonals of that box away"),
         ("radius_self", "all within a radius, chosen to hold about 30 points, of a point of the cloud"),
         ("box_self", "all in a box of about 30 points around a point of the cloud"),
         ("knn8_threads, radius_threads", "the same as those ending in _self, many more queries, for thread scaling")),
        "The hard cases are clouds of floats. Those that answer in doubles, and those that round doubles, are asked where "
        "float cannot hold a cloud (georeferenced)."),
    "knn_dynamic": TaskText(
        "Points that come and go",
        "What does it cost that points come and go, and what do queries lose by it?",
        "point", "operation", "mean relative error",
        "As for neighbours in point clouds, over the points that are there when a query is asked; what has gone is no "
        "answer. Timed is a whole life: twice as many points come as are there at a time, and from then on as many go. "
        "An operation is a point that comes, a point that goes, or a query.",
        (("single", "one point at a time; the oldest go. Building anew is not tried"),
         ("batches128, batches16, batches4", "the cloud in 128, 16 or 4 batches; the oldest go"),
         ("random16", "in 16 batches; random points go"),
         ("asked16", "in 16 batches; after each the 8 nearest of every point that came are asked for"),
         ("knn8_after", "the 8 nearest of points, where 128 batches to the cloud have left it"))),
    "knn_nd": TaskText(
        "Neighbours in many dimensions",
        "Which rows of a matrix of many columns lie nearest to a query that is not among them?",
        "row", "query", "1 − recall",
        "The share of the true nearest that the answer misses, by distance, so that ties are free. Not the excess of the "
        "distances: in many dimensions even a random row is hardly farther than the nearest. error_mean and bias are that "
        "excess.",
        (("knn1, knn10, knn100", "the 1, 10 or 100 nearest of a row that was held out"),)),
    "ray": TaskText(
        "Rays through triangle meshes",
        "Which triangle does a ray meet first, and does it meet any?",
        "triangle", "ray", "mean relative error",
        "The relative error of the hit distance; a false hit or a false miss counts 1. An answer that is right for a ray "
        "moved by the rounding of its coordinates counts as right.",
        (("camera", "the closest hit of rays from one eye, in the order of pixels"),
         ("camera_shuffled", "the same rays in random order"),
         ("camera_any", "whether those rays hit anything"),
         ("diffuse", "the closest hit of rays that bounce off what the camera sees, in the order of pixels"),
         ("bounce2", "the closest hit of the next bounce, in random order"),
         ("random", "the closest hit between random points of the mesh's box and beyond"),
         ("shadow", "whether anything stands between what the camera sees and a light"),
         ("axis", "the closest hit along an axis: two components of the direction are 0 or −0"),
         ("grazing", "the closest hit of rays almost in a triangle's plane, where t slides"),
         ("edge", "the closest hit of rays aimed at edges and vertices, where leaks show"),
         ("frame…_refit, frame…_rebuilt",
          "the closest hit after the vertices have moved, on an index that was refitted, or built anew"),
         ("camera_threads, random_threads, shadow_threads",
          "the same as those without _threads, many more rays, for thread scaling"))),
    "light_transport": TaskText(
        "Light in rooms",
        "What radiance does each pixel of a camera see in a room?",
        "triangle", "pixel", "relative RMS error (root of relMSE)",
        "The root of the mean, over pixels and channels, of the squared error over the square of the truth and of a tenth of its "
        "mean; bias is the signed mean over the mean radiance. A method that claims to be stochastic has no bias but chance: "
        "its row is wrong if the mean is off by more than five standard errors. Truths are formulas, or converged in two "
        "halves. Times are of a pixel with all its samples; the tree is made in the build.",
        (("image", "all that the camera sees"),
         ("walls", "the mean radiance of each wall of the closed box, which is known without a ray"),
         ("image_threads", "the same as image, more pixels, for thread scaling")),
        methods=(
         ("path_uniform, path_cosine, path_bsdf", "paths that go on evenly over the hemisphere, by the cosine, or by the surface's own "
          "sampler, and find lamps by chance"),
         ("next_event_uniform, next_event_cosine, next_event_bsdf", "the same, with a ray to a lamp from every point"),
         ("mis, mis_embree", "both, weighted by the power heuristic; over our tree and over Embree's"),
         ("whitted", "rays that multiply at mirrors and glass, and end on all else"),
         ("textbook_literal, textbook_corrected", "a path tracer as textbooks print it, slip by slip, and put right")),
        mean=False),
    "region_average": TaskText(
        "Means of regions of textures",
        "What is the mean of a region of a texture?",
        "texel", "query", "root mean square error over the range",
        "How far a mean is off, over the range of the texture's values. Beyond its borders a texture goes on as its outermost "
        "texels. Tables promise boxes along the axes alone, and give other shapes the box of their variances; pyramids "
        "promise nothing. Sizes are in texels; sets called …_sorted ask the same footprints in the order of a picture.",
        (("texel, aligned16", "squares of 1 and 16 whole texels, with corners at multiples of their side"),
         ("square4, square24", "squares anywhere"),
         ("oblong", "64 x 4 and 4 x 64, anywhere"),
         ("rotated", "32 x 8, at any angle"),
         ("disc", "of radius 12"),
         ("gaussian", "of deviation 6, cut off at three deviations"),
         ("build", "the structure is made anew, in its own memory; a query is a texel; that of nearest is a plain copy"),
         ("square24_threads, build_threads", "the same as those without _threads, for thread scaling")),
        methods=(
         ("mip_square, mip_probes, mip_anisotropic", "one look-up between two levels of a pyramid, a grid of them, or a row along the region"),
         ("sat_float, sat_double, sat_uint32, sat_int64", "tables of sums, by the number that they are kept in"),
         ("sat_centred", "sums in float of the values less about their mean, so that they stay small"),
         ("brute", "all texels of the region")),
        mean=False),
    "closest_point": TaskText(
        "Closest points of triangle meshes",
        "Which point of a mesh lies nearest to a query, and on which triangle?",
        "triangle", "query", "mean error over the diagonal",
        "Over the diagonal of the mesh's box, the larger of two: how far the distance to the point answered is from the true "
        "one, and how far that point lies off the triangle named. No answer where there is one counts 1. Methods called "
        "bvh_decimated search a mesh of fewer faces: of them only the distance is judged.",
        (("near", "a thousandth of the diagonal off a random point of the surface, in random order"),
         ("near_sorted, uniform_sorted", "the same queries, each near the one before"),
         ("uniform", "anywhere in the mesh's box"),
         ("far", "two to four diagonals away"),
         ("centre", "in the middle of the box, where much is about as near"),
         ("on_vertex", "a vertex, or a point that shares one or two coordinates with one"),
         ("near_threads, uniform_threads", "the same as those without _threads, more queries, for thread scaling"))),
    "shadow": TaskText(
        "Shadows",
        "How much of the light does each point see that the camera sees?",
        "triangle", "pixel", "RMS error of the share of light seen",
        "Over the pixels whose surface has the whole light above it, the root of the mean square of how far the share of the "
        "light is off; bias is the signed mean, above 0 too light. At a hard shadow's border every map is wrong somewhere, so "
        "that single pixels are no limit. A share is one of the light's area, not weighted by a cosine. Times are of a query; "
        "maps, fields and trees are made in the build.",
        (("image", "all that the camera sees"),
         ("edge", "a line across a penumbra"),
         ("contact", "from the foot of a wall into its shadow"),
         ("leak", "below two or three blockers, where none is lit"),
         ("motion", "how the answer changes while the light moves by tenths of a texel, beside how it should")),
        methods=(
         ("midpoint, dual_depth, second_depth", "maps of depths halfway to the second surface, the same but little behind the first, "
          "and of the second surface itself"),
         ("pcf, pcf_disc, pcss", "a share of taps that pass, in a box, in a disc, and in one as wide as the blockers' distance says"),
         ("vsm, evsm2, evsm4", "two moments of depth (variance shadow maps); of depth warped by one exponential, and by two"),
         ("esm", "exponential shadow maps: exp(c z), filtered"),
         ("msm, msm16", "four moments of depth (moment shadow maps), in float and in 16 bits"),
         ("vssm", "pcss with the variance of a box for its taps"),
         ("redrawn_map, embree_redrawn_map", "a map drawn anew for every image, by our rasteriser and by Embree's rays"),
         ("shadow_volumes, shadow_volumes_z_pass", "crossings of the borders of shadows, counted from infinity or from the eye")),
        mean=False),
}  # fmt: skip


def text(task):
    return TASKS.get(task) or TaskText(task, "", "element", "query", "error")
