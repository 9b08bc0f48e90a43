/* SPDX-License-Identifier: GPL-3.0-or-later */
/* clang-format off */
/* The painted controls, in the order of the channels of the layer `controls`; each -1..1, neutral at 0.
 *
 *   CONTROL(NAME, name, label, what white does, what black does, saved pass, its channel)
 *
 * A mesh carries one as its attribute encre_<name>; stages read channel CONTROL_NAME of controls_at() (stage.h). Files
 * keep it in a channel, 0 to 2, of a pass; both are for ever. No guard: included once per use, which defines CONTROL. */
CONTROL(THICKNESS, "thickness", "Thickness", "lines nine times as thick", "no line", "Encre Line Controls", 0)
CONTROL(INTENSITY, "intensity", "Intensity", "full pressure", "no ink", "Encre Line Controls", 1)
CONTROL(COLOR_EDGE, "color_edge", "Color Edge", "draws the boundaries of colors", "never draws them", "Encre Line Controls", 2)
CONTROL(SMUDGE_RANGE, "smudge_range", "Smudge Range", "color from behind spreads over the outline", "color spreads from in front", "Encre Surface Controls", 0)
CONTROL(SMUDGE_FALLOFF, "smudge_falloff", "Smudge Falloff", "it stays full over half its reach", "it fades at once", "Encre Surface Controls", 1)
CONTROL(HATCHING, "hatching", "Hatching", "more pencil", "no pencil", "Encre Surface Controls", 2)
CONTROL(LIGHT, "light", "Light", "half more light, before it is cut into levels", "half less", "Encre Light Controls", 0)
#undef CONTROL
