"""What names of methods, query sets and datasets leave open, beside the texts of tasks.py."""

# {task: ((names of methods, what they do), …)}
METHODS = {
    "closest_point": (
        ("bvh_wide, bvh_wide_exact", "a hierarchy of many children a node, with the answers of double; the second decides exactly "
         "which triangle is nearest. Its knob order: queries as they are given, or along a curve through space"),
        ("bvh_decimated", "the same over what decimation leaves of the mesh"),
        ("embree_point_query", "Embree walks its tree and calls back for each triangle in reach; its knob kernel: what measures them")),
    "distance_field": (
        ("dense, dense_cubic", "samples at every corner of a grid of cells, looked up between the 8 nearest, or the 64 nearest by "
         "cubics; far from the surface a sample says only that it is far"),
        ("bricks, bricks_cubic", "the same samples, kept in bricks near the surface alone"),
        ("bricks_signs", "bricks whose sign comes from another rule, its knob sign: how often the mesh goes around, the face that a "
         "ray meets first, how many it meets, or normals"),
        ("bvh", "no field: the tree is asked for the nearest triangle and the side"),
        ("openvdb", "OpenVDB's level set in a narrow band")),
    "knn": (
        ("bvh_wide", "a hierarchy of many children a node; its knob batch: all queries at once, or a call for each"),
        ("bvh_wide_epsilon", "its distances may be too long by the factor 1 + epsilon"),
        ("bvh_wide_leaves", "its search ends after so many leaves, whatever it has found"),
        ("bsp_spill", "the two sides of each plane overlap by tau, in units of the cloud's spacing, and a query goes down its own alone"),
        ("…_double", "over points and queries in double"),
        ("…_rounded", "over doubles made floats"),
        ("flann_forest, flann_kmeans", "several randomised KD trees, or a tree of clusters; a search ends after so many checks"),
        ("pcl_octree", "voxels of one size, its knob resolution, with a list of points each")),
    "knn_dynamic": (
        ("forest_bvh_wide", "a forest of static trees, of which those are built anew that changed"),
        ("rebuilt_bvh_wide, rebuilt_nanoflann", "one static tree, built anew after each batch"),
        ("nanoflann_dynamic", "nanoflann's own adaptor for points that come and go")),
    "knn_nd": (
        ("kd_tree_eps, bsp_tree_eps", "distances may be too long by the factor 1 + epsilon"),
        ("kd_tree_visits, bsp_tree_visits", "a search ends after so many rows, max_rows"),
        ("bsp_tree", "planes across the axis along which the rows spread most, or across a random direction: its knob split"),
        ("spill_tree", "a bsp_tree whose sides overlap by a share of their rows, so that a search that ends early finds more"),
        ("kd_forest, rp_forest", "several trees searched together: KD trees of random columns, or planes across random directions"),
        ("flann_forest, flann_kmeans, flann_linear, flann_single", "randomised KD trees; a tree of clusters; every row; one exact KD tree")),
    "ray": (
        ("…_fast", "the same tree with Möller and Trumbore's test in its leaves, which leaks at edges; the others' is watertight"),
        ("bvh_wide", "a hierarchy of many children a node (its knob width); builder: how it is made; batch: one ray after the other, "
         "several in flight, or packets of neighbours"),
        ("bvh_wide_compact", "the same in half the memory: planes of boxes in 8 or 16 bits"),
        ("bvh_wide_exact", "the same with leaves that decide exactly"),
        ("embree_single, embree_stream", "one ray a call, or a whole run; embree_packet8 and embree_packet16: 8 and 16 rays"),
        ("cgal_aabb, cgal_aabb_epick", "over plain doubles, and with exact predicates"),
        ("pcl_octree", "PCL's voxels, each with the triangles that reach into it, which are tested here"),
        ("slab_textbook, slab_padded", "one box and no tree: the slab test as courses print it, and with room for rounding")),
}  # fmt: skip

# {task: ((names of query sets, what is asked), …)}
QUERY_SETS = {
    "shadow": (("top", "the upper face of a slab alone: midpoints of depth lie within it, and a thin one shadows itself"),),
}  # fmt: skip

DATASETS = {
    "icosphere": "a rough ball: a sphere of even triangles, displaced",
    "displaced_sphere": "on the surface of a rough ball",
    "nested_shells": "eight rough spheres, one inside the other",
    "torus_knot": "a smooth tube with a knot in it",
    "terrain": "hills and ridges, open",
    "architecture": "large walls, long thin beams, fine ornament",
    "forest": "a soup of leaves",
    "needles": "thin triangles with one short side",
    "caps": "thin triangles with one corner almost on the side across",
}  # fmt: skip


def dataset(name):
    """In a few words, or nothing; a damaged one is as it was before."""
    return DATASETS.get(name.partition("+")[0], "")
