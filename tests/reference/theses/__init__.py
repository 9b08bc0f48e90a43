# SPDX-License-Identifier: GPL-3.0-or-later
"""Both theses' own chains of picture stages, written again from their text in numpy, without a look at the product or
its twins: what *After W* and *After H* are held to. Where the text is silent the constants are those of W's public
shaders, which docs/theses.md lists."""
