# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line.

In: arguments, files. Out: files, sentences on the standard error, an exit status: 0; 2 for usage, input and an output
that can't be written; 1 for what fails under way; 130 when interrupted. A file is written whole or not at all.

main reads the arguments and has one function for each command. render starts a Blender that runs inside, the only file
here that knows Blender, and shows what that reports; composite and bake work without any; images reads and writes files
by OpenImageIO; interrupt makes Ctrl-C stop the library; tools finds the benchmarks of a checkout.

To add: a command to main._parser(), with its work in a file of its own; a kind of file to images. render gives inside a
JSON file with what to do, and reads lines of JSON from it: a new word between them goes into both.
"""
