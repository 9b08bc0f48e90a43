# SPDX-License-Identifier: GPL-3.0-or-later
"""Encre inside Blender: the engine, what it reads of a scene, and what a user sees of it.

In: Blender's hooks, with the evaluated scene; the passes that Cycles writes into the result. Evaluated data alone are
read, so that keyframes and drivers count, and only evaluated data are changed: the user's scene stays as it is. Out:
the result with Encre's pictures in the place of the passes; sentences in Blender's report.

engine forwards the hooks to frame, which does one render: before Cycles, and after it by drawing; fast_frame does one
without Cycles. It reads settings by properties, objects by meshes with triangles, cameras and images; overrides
switches off in the evaluated scene what lines can't do with; subframes has Cycles render larger layers; early inks a
picture that grows, escape after a break; memory keeps the last render's layers, or those of a file that is opened,
which redraw draws again, and instant while a setting is dragged; live inks rendered 3D views: eye tells what they look
at, looks by which settings they draw, unread when nothing of the scene has changed, screen draws in them; threads holds
what Python needs on a render's thread and beside one. bake draws into textures; panels shows it all, with thumbnails of
presets, in other languages by languages; pens has what artists call theirs, front what is said of many settings at
once.

wanted asks a view layer for passes, known is what of one is known before. fast reads a scene once, and fast_scene draws
its layers from any side: materials compiles node trees, by nodes, shaders, inputs, patterns, values and sums, with
trees to follow links, attributes for what meshes have, pictures and their spaces of colours, colored which materials
have theirs from an image alone; hair makes triangles of strands, cutouts tells where surfaces are solid, worlds and
volumes what is around, mirrors what flat ones show, filters what a view layer leaves out, unseen says what Encre does.
lamps is the drawn light's scene, meter how much is full light, subject how far away the picture's subject stands.
painting makes and fills attributes of controls, control_nodes does so by Geometry Nodes, strokes turns drawings into
marks, grease the picture's lines into drawings. handlers is what Blender calls by itself, migration keeps old files'
look, chosen gives new scenes a first one, listener waits for a key.
study shows people two looks side by side and asks which they prefer.
skies tells the light of a world and what is seen of it, receivers what light things receive.

To add: a setting of an object or a material to properties; what else a mesh tells to triangles; what depends on the
number of Blender's version to versions, with the reason, and nowhere else. Nothing here knows the command line.
"""

ENGINE = "ENCRE"  # how files name the engine
