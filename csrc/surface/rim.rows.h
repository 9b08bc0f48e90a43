/* SPDX-License-Identifier: GPL-3.0-or-later */
/* clang-format off */
STAGE(rim, "Rim Light", "A band of light along the silhouettes of things")
SWITCH(use_rim, SURFACE, 0, "", "Rim Light", "Draw a band of light, a rim or edge light, along the silhouettes of things")
FLOAT(rim_width, SURFACE, 8, 0, 256, 0, 32, "px", "use_rim", "Width", "Largest width of the band")
FLOAT(rim_facing, SURFACE, 0.8, 0, 1, 0, 1, "factor", "use_rim", "Facing Limit", "How much a surface may face the camera and still have the band. Below 1 small things have a narrow band, and walls that face the camera none. 1: full width everywhere")
ENUM(rim_space, SURFACE, 0, "use_rim", "From", "Whether the rim light comes from a side of the picture or of the world",
     ITEM(rim_space, PICTURE, 0, "Picture", "A side of the picture, however the camera turns")
     ITEM(rim_space, WORLD, 1, "World", "A direction in the world, like a sun's"))
FLOAT(rim_angle, SURFACE, 135, -180, 180, -180, 180, "degrees", "use_rim", "Angle", "Where the rim light comes from. In the picture 0 is right and 90 above; in the world 0 is along X and 90 along Y")
FLOAT(rim_elevation, SURFACE, 30, -90, 90, -90, 90, "degrees", "use_rim&rim_space=WORLD", "Elevation", "How high above the horizon the rim light comes from. 90: straight from above")
FLOAT(rim_spread, SURFACE, 180, 0, 180, 0, 180, "degrees", "use_rim", "Spread", "How far around the object the band goes from there, narrower toward its ends. 180: all around")
FLOAT(rim_softness, SURFACE, 0, 0, 1, 0, 1, "factor", "use_rim", "Softness", "0: the band has a sharp edge. 1: it fades over its whole width")
COLOR(rim_color, SURFACE, 1, 1, 1, "use_rim", "Color", "Color of the band")
FLOAT(rim_tint, SURFACE, 0, 0, 1, 0, 1, "factor", "use_rim", "Surface Color", "How much the color of the surface shows in the band. 0: the band is paint, 1: it is light")
FLOAT(rim_strength, SURFACE, 1, 0, 1, 0, 1, "factor", "use_rim", "Strength", "How opaque the band is")
