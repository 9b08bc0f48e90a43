# SPDX-License-Identifier: GPL-3.0-or-later
"""The library from Python, and all that needs no Blender.

In: numpy arrays of float32, row 0 at the top, as Cycles or a saved file gives them; values of parameters, of any form.
Out: arrays again; values checked; one sentence (errors.EncreError) for what the user can mend.

library binds the C functions, abi has their structures, scene is what drawn light falls on, params has their table of
parameters, slots which of these are whose pen's and tone's, job what they take and give, chains the lines that meshes
tell of as a picture and its file have them, plane puts drawn strokes before a camera. settings checks values once and
tells what they ask for; layers and overlay put layers together from passes; saved packs them for a file and unpacks
them, slim for little room; stored tells what a file's channels are, exr reads them where no library is at hand;
metadata and presets write and read values; installed tells where the library's file lies, background has works that go
on beside Python, around what a part of a frame needs about it, shown pictures of how one comes about. denoise,
supersample, unwrap and colour are pictures' arithmetic, even takes what is left of noise out of light, along makes its
curves calm, through makes surfaces whole that let some light through, haze those that fog hides from some samples,
irradiance and sky are the light of a world, program what a material computes, tangents where U grows along a surface,
ribbons what strands are to who looks; plain opens files that others name. session is a person's way through the study,
and the file of it.
daylight is the light of a clear day, suns what of a picture of the world throws shadows, backdrop such a picture in
flat shapes.

To add: what the engine and the command line both need comes here, if it can do without Blender; numpy only. C's structs
stand in abi alone, after encre.h; no parameter's default, range or label stands here, as the table tells them.
"""
