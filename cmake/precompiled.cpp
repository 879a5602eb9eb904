// Each set of precompiled headers needs a source to belong to: see treeline_precompiled_set.
