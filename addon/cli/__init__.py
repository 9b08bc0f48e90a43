# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line.

In: arguments, files. Out: files, sentences on the standard error, an exit status: 0; 2 for usage, input and an output
that can't be written; 1 for what fails under way; 75 for what may not another time; 130 when interrupted. A file is
written whole or not at all.

arguments knows what the command line may hold, main has one function for each command. render has child start a Blender
that runs inside, and talks with it on a private line; frames says what it draws next, and where pictures go. staging
sets up the scene there, trust keeps a stranger's from doing harm, needed finds the files that it lacks, inputs all that
it reads: these, inside and study/windowed.py alone know Blender. progress shows what is said; sequence knows frames,
their files and the marks by which finished ones are known. restyle has composite draw files again, and bake works on
textures, both without any Blender; images reads and writes files by OpenImageIO, multilayer those of passes, whose
pixels planes finds where they lie, png what is to be seen, which view makes of light; room holds large ones and refuses
what there is no room for, denoiser cleans light, installed finds what Blenders here bring along for that and for view;
interrupt makes Ctrl-C stop the library; tools finds the benchmarks of a checkout; start is what processes are begun by,
and shadows tells which modules PYTHONPATH puts in the place of others.

Rooms: sharing, for frames that several processes draw; farms, for jobs of farms' own systems; passes, for files of
other renderers; study, for people who compare looks.

To add: a command to arguments.parser() and main.COMMANDS, its work in a file of its own; a kind of file beside png.
render gives inside a JSON file with what is to be done, and one frame after the other on the line: a new word between
them goes into both.
"""
