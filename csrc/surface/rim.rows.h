/* SPDX-License-Identifier: GPL-3.0-or-later */
/* clang-format off */
STAGE(rim, "Rim Light", "A band of light along the silhouettes of things")
SWITCH(use_rim, SURFACE, 0, "", "Rim Light", "Draw a band of light, a rim or edge light, along the silhouettes of things")
FLOAT(rim_width, SURFACE, 8, 0, 256, 0, 32, "px", "use_rim", "Width", "How wide the band is at most")
FLOAT(rim_facing, SURFACE, 0.8, 0, 1, 0, 1, "factor", "use_rim", "Facing Limit", "How far a surface may face the camera and still have the band: small things then have a narrow one, and walls that face the camera none. 1: the band has its width everywhere")
ENUM(rim_space, SURFACE, 0, "use_rim", "From", "What tells from where the light comes",
     ITEM(rim_space, PICTURE, 0, "Picture", "A side of the picture, however the camera turns")
     ITEM(rim_space, WORLD, 1, "World", "A direction in the world, like a sun's"))
FLOAT(rim_angle, SURFACE, 135, -180, 180, -180, 180, "degrees", "use_rim", "Angle", "Where the light comes from: on the picture 0 is right and 90 above; in the world 0 is along x and 90 along y")
FLOAT(rim_elevation, SURFACE, 30, -90, 90, -90, 90, "degrees", "use_rim&rim_space=WORLD", "Elevation", "How high above the horizon it comes from; 90: straight from above")
FLOAT(rim_spread, SURFACE, 180, 0, 180, 0, 180, "degrees", "use_rim", "Spread", "How far round from there the band goes, getting narrower towards its ends; 180: all round")
FLOAT(rim_depth, SURFACE, 0.05, 0, FLT_MAX, 0, 1, "", "use_rim", "Depth Difference", "How far behind a silhouette the next surface must lie at least, as a share of the distance")
FLOAT(rim_softness, SURFACE, 0, 0, 1, 0, 1, "factor", "use_rim", "Softness", "0: the band has an edge; 1: it fades over its whole width")
COLOR(rim_color, SURFACE, 1, 1, 1, "use_rim", "Color", "Color of the band")
FLOAT(rim_tint, SURFACE, 0, 0, 1, 0, 1, "factor", "use_rim", "Surface Color", "How far the band's color is multiplied by the surface's: 0 is paint, 1 light")
FLOAT(rim_strength, SURFACE, 1, 0, 1, 0, 1, "factor", "use_rim", "Strength", "How much the band covers")
