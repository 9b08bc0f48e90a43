/* SPDX-License-Identifier: GPL-3.0-or-later */
/* clang-format off */
STAGE(edges, "Edges", "Where lines can be: jumps in depth, creases, boundaries between objects, materials, colours and light levels")
ENUM(edge_detector, FRAME, 2, "", "Detector", "How edges are found in the layers",
     ITEM(edge_detector, DOG, 0, "Difference of Gaussians", "Second derivative; soft, a few pixels wide")
     ITEM(edge_detector, SOBEL, 1, "Sobel", "First derivative of the normal, contrast between colours")
     ITEM(edge_detector, FINE, 2, "Fine", "Thin lines, placed between pixels exactly where surfaces part"))
FLOAT(edge_threshold, FRAME, 0.5, 0, FLT_MAX, 0, 2, "", "", "Threshold", "Weighted strength from which a pixel is an edge")
FLOAT(edge_sigma, FRAME, 1, 0.5, 4, 0.5, 4, "", "edge_detector=DOG", "Sigma", "Standard deviation of the narrower Gaussian, in pixels")
FLOAT(edge_object, SURFACE, 1, 0, FLT_MAX, 0, 4, "", "", "Object", "Weight of boundaries between objects")
FLOAT(edge_material, SURFACE, 0, 0, FLT_MAX, 0, 4, "", "", "Material", "Weight of boundaries between materials")
FLOAT(edge_depth, SURFACE, 1, 0, FLT_MAX, 0, 4, "", "", "Depth", "Weight of jumps in depth")
ENUM(depth_space, FRAME, 0, "edge_depth&edge_detector=DOG|SOBEL", "Depth Space", "The quantity in which depth is compared",
     ITEM(depth_space, INVERSE, 0, "Inverse", "One over depth: planes stay clean at any angle, at any scene scale")
     ITEM(depth_space, LINEAR, 1, "Linear", "Depth between Near and Far"))
FLOAT(depth_near, FRAME, 0.1, 0, FLT_MAX, 0, 100, "length", "depth_space=LINEAR", "Near", "Depth that counts as 0")
FLOAT(depth_far, FRAME, 100, 0, FLT_MAX, 1, 1000, "length", "depth_space=LINEAR", "Far", "Depth that counts as 1; must be beyond Near")
FLOAT(edge_normal, SURFACE, 1, 0, FLT_MAX, 0, 4, "", "", "Normal", "Weight of creases")
FLOAT(crease_angle, SURFACE, 32, 1, 180, 1, 90, "angle", "edge_normal&edge_detector=FINE", "Crease Angle", "Surfaces that bend by this angle or more have a line there")
FLOAT(crease_smooth, SURFACE, 60, 1, 180, 1, 180, "angle", "edge_normal&edge_detector=FINE&crease_source=AUTO", "Smooth Crease Angle", "The same for edges of meshes that are shaded smoothly")
ENUM(crease_source, FRAME, 0, "edge_normal&edge_detector=FINE", "Creases From", "What tells where surfaces bend",
     ITEM(crease_source, AUTO, 0, "Meshes", "The edges of meshes, and the normals where no mesh tells: hair, displacement, pictures of other renderers")
     ITEM(crease_source, LAYERS, 1, "Normals", "The normals everywhere: bumps and noise can be lines, and shallow bends are"))
FLOAT(edge_bump, SURFACE, 0, 0, FLT_MAX, 0, 4, "", "edge_detector=FINE&crease_source=AUTO", "Bumps", "Weight of creases that the normals show and no mesh has, as those of bump and normal maps")
FLOAT(sobel_shape_threshold, FRAME, 0.25, 0, FLT_MAX, 0, 1, "", "edge_detector=SOBEL", "Shape Threshold", "Creases weaker than this are not drawn")
FLOAT(edge_color, SURFACE, 0, 0, FLT_MAX, 0, 4, "", "", "Color", "Weight of boundaries between colours, to which the painted control is added")
ENUM(color_layer, FRAME, 0, "", "Color Layer", "The colours that are compared",
     ITEM(color_layer, ALBEDO, 0, "Albedo", "Unlit colours: lines do not move with the light")
     ITEM(color_layer, LIT, 1, "Lit", "The rendered image"))
FLOAT(edge_light, SURFACE, 0, 0, FLT_MAX, 0, 4, "", "", "Light", "Weight of boundaries between levels of discrete light")
FLOAT(edge_mark, SURFACE, 1, 0, FLT_MAX, 0, 4, "", "", "Marked Edges", "Weight of edges of meshes that are marked by hand, as Freestyle edges")
FLOAT(edge_seen, SURFACE, 1, 0, FLT_MAX, 0, 4, "", "edge_detector=FINE", "Seen", "Weight of lines in what mirrors and clear glass show")
ENUM(color_detector, FRAME, 1, "edge_detector=DOG", "Color Detector", "How colour and light are compared",
     ITEM(color_detector, DOG, 0, "Difference of Gaussians", "As the other layers")
     ITEM(color_detector, CONTRAST, 1, "Contrast", "Contrast of opposing neighbours in the chosen metric"))
ENUM(contrast_metric, FRAME, 0, "color_detector=CONTRAST", "Metric", "Measure of the difference between two colours",
     ITEM(contrast_metric, RGB, 0, "Weighted RGB", "Fast and close to perception")
     ITEM(contrast_metric, CIE76, 1, "CIE76", "Euclidean distance in CIE L*a*b*")
     ITEM(contrast_metric, CIEDE2000, 2, "CIEDE2000", "The CIE's formula of 2000")
     ITEM(contrast_metric, CMC, 3, "CMC l:c (2:1)", "The textile industry's formula, the larger of its two orders"))
FLOAT(contrast_threshold, FRAME, 0.01, 0, FLT_MAX, 0, 1, "", "color_detector=CONTRAST", "Contrast Threshold", "Differences below this give no edge")
FLOAT(contrast_max, FRAME, 1, 0, FLT_MAX, 0, 1, "", "color_detector=CONTRAST&!contrast_auto", "Full Contrast", "Difference that gives an edge of full strength")
BOOL(contrast_auto, FRAME, 0, "color_detector=CONTRAST", "Local Contrast", "The strongest difference nearby gives an edge of full strength")
FLOAT(contrast_window, FRAME, 64, 1, 4096, 8, 256, "px", "contrast_auto", "Window", "Width of the neighbourhood of Local Contrast")
