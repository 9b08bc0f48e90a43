# SPDX-License-Identifier: GPL-3.0-or-later
"""Every parameter with its default, and which style a value is read from."""

import numpy as np

# What settings call the lines of a source.
CALLED = {"object": "outline", "depth": "inner", "normal": "crease", "material": "material", "color": "color",
          "light": "shadow", "mark": "mark", "seen": "mirror", "suggestive": "suggestive", "hidden": "hidden"}
KINDS = ("outline", "contact", "inner", "crease", "intersection", "material", "color", "shadow", "mirror", "mark",
         "suggestive", "hidden")


def strength(source):
    """The setting of the strength of a source's lines."""
    return f"line_{CALLED[source]}_strength"


def width(source):
    """That of their width."""
    return f"line_{CALLED[source]}_width"


def shortest(source):
    """That of the length below which they are thinner."""
    return f"line_{CALLED[source]}_shortest"


DEFAULTS = {
    # edges
    "edge_detector": "DOG", "depth_space": "INVERSE", "color_detector": "CONTRAST", "color_layer": "ALBEDO",
    "edge_threshold": 0.5, "edge_blur": 1.0, "depth_near": 0.1, "depth_far": 100.0,
    "line_inner_strength": 1.0, "line_crease_strength": 1.0, "line_outline_strength": 1.0,
    "line_material_strength": 0.0, "line_color_strength": 0.0, "line_mirror_strength": 1.0,
    "line_shadow_strength": 0.0, "line_mark_strength": 1.0, "line_suggestive_strength": 0.0, "flush_pieces": False,
    "line_hidden_strength": 0.0, "hidden_most": 1,
    "suggestive_size": 6.0, "line_suggestive_shortest": 48.0, "line_shadow_shortest": 0.0,
    "line_color_shortest": 0.0, "color_smooth": True, "line_mirror_shortest": 0.0,
    "sobel_crease_threshold": 0.25,
    "crease_angle": 32.0, "crease_angle_smooth": 60.0, "crease_source": "AUTO", "crease_bumps": 0.0,
    "contrast_hue": 1.0, "contrast_saturation": 1.0, "contrast_lightness": 1.0,
    "contrast_metric": "RGB", "contrast_threshold": 0.01, "contrast_full": 1.0,
    "contrast_local": False, "contrast_window": 64.0,
    # lines
    "use_lines": True, "line_thickness": 8.0, "line_thickest": 128.0, "line_contrast": 0.0,
    "line_outline_width": 1.0, "line_material_width": 1.0, "line_inner_width": 0.8, "line_crease_width": 0.6,
    "line_color_width": 0.6, "line_shadow_width": 0.5, "line_mirror_width": 1.0, "line_mark_width": 1.0,
    "line_suggestive_width": 0.6, "line_hidden_width": 0.4, "line_far_distance": 0.0,
    "line_far_unit": "RELATIVE", "line_far_thickest": 4.0, "line_far_thinnest": 0.0,
    "ink_in_shade": 0.0, "line_shortest": 12.0, "line_smooth": 2.0, "line_gap": 0.0,
    "line_halo": 0.0, "line_halo_color": (1.0, 1.0, 1.0), "line_outer_width": 1.0, "line_occlude": True,
    "line_search": "EXACT", "line_density": 1.0, "line_fewer": 0.0, "ink_color": (0.0, 0.0, 0.0), "ink_tint": 0.0,
    "ink_tint_value": 0.35, "line_contact_width": 1.0, "line_intersection_width": 1.0,
    **{pen + name: value for pen in ("pen_1_", "pen_2_", "pen_3_") for name, value in {
        "pressure": 0.0, "pressure_length": 210.0, "curve": 0.0, "wobble": 0.0, "wobble_length": 135.0,
        "rough": 0.0, "rough_length": 12.0, "gaps": 0.0, "gaps_length": 90.0,
        "dry": 0.0, "strokes": 1, "seed": 0, "hold": 0, "boil": 1.0,
        "strip": 0.0, "strip_length": 300.0, "dash": 0.0, "dash_space": 10.0, "overshoot": 0.0, "overshoot_color": 1.0,
        "pool": 0.0, "width": 1.0, "taper": 0.0, "softness": 0.9, "intensity": 1.0, "steepness": 4.0,
        "grain": 0.6}.items()},
    "ink_on_dark": 0.0, "ink_dark_color": (1.0, 1.0, 1.0), "ink_dark_threshold": 0.03, "ink_dark_width": 1.0,
    "ink_dark_colors": 1.0,
    "ink_in_light": 0.0, "ink_light_color": (0.5, 0.25, 0.1), "ink_by_kind": False,
    **{f"line_{kind}_{what}": value for what, value in (("ink", (0.0, 0.0, 0.0)), ("pen", "PEN_1")) for kind in KINDS},
    "surface_fade": 0.0, "length_unit": "RELATIVE", "supersample": 1.0,
    # shading
    "use_shading": True, "shade_levels": [(0.5,), (0.7, 0.5, 0.025), (1.1, 0.9, 0.025)],
    "shade_exposure": 1.0, "shade_meter": "SCENE", "meter_light": 1.0, "meter_shade": 0.0,
    "shade_tint": (0.60, 0.55, 0.90), "shade_tint_weight": 1.0,
    "shade_saturation": 0.6, "shade_beyond": False, "shade_strength": 1.0, "other_light": 1.0,
    "light_hue": 1.0,
    "other_background": 1.0, "other_highlights": 1.0, "other_reflections": 1.0, "other_glow": 1.0,
    "highlight_shape": 0.0, "reflection_tones": 0, "highlight_threshold": 0.8,
    "highlight_color": (1.0, 1.0, 1.0), "surface": "SHADED", "paper_color": (1.0, 1.0, 1.0),
    # by example
    "use_example": False, "example_ball": "GOUACHE", "example_image": None, "example_strength": 1.0,
    "example_own_color": 1.0, "example_light": 0.75, "example_loose": 0.5, "example_size": 800.0,
    # gouache
    "use_gouache": False, "gouache_size": 100.0, "gouache_variety": 1.0, "gouache_body": 1.0,
    # smudging
    "use_smudging": True, "smudge_range": 10.0, "smudge_pick": 7.0, "smudge_depth": 0.01,
    "smudge_falloff": 0.5, "smudge_curve": 1.0,
    # hatching and paper
    "use_hatching": True, "hatch_amount": 0.45, "hatch_color": (0.0, 0.0, 0.0),
    "hatch_color_threshold": 0.35, "hatch_light_threshold": 0.5, "hatch_color_light": 0.5,
    "paper_source": "COLD_PRESS", "paper_image": None, "paper_scale": 1.0, "paper_roughness": 1.0,
    "paper_seed": 0,
    # tones
    "use_tones": False, "tone_darkness": 0.0, "tone_black": 0.0, "tone_dark": 0.0, "tone_reds": 0.0, "tone_form": 0.0,
    "tone_crumbs": 0.0,
    "tone_black_by": "VALUE", "tone_local": 0.0, "tone_open": 0.0, "tone_mirrors": False, "tone_sky": 0.0,
    "tone_detail": 0.0, "tone_least": 0.0, "tone_black_widest": 0.0, "tone_crisp": False, "tone_pitch_unit": "LENGTH",
    "tone_strokes": "FORM", "tone_light_direction": 135.0, "tone_light_height": 45.0,
    "page_height": 257.0,
    **{f"tone_{n}": kind for n, kind in enumerate(("DOTS", "DOTS", "NONE", "NONE", "SAME", "SAME"), 1)},
    **{f"tone_{n}_{id_}": value for n in range(1, 7) for id_, value in
       dict(pitch=8.0, image=None, angle=45.0, space="SCREEN", gradient=0.0, color=(0.0, 0.0, 0.0)).items()},
    # wash
    "use_wash": False, "wash_density": 1.0, "wash_color": 1.08, "wash_white": 0.93, "wash_glaze": (0.77, 0.79, 0.91),
    "wash_shade": 1.0, "wash_wet": 0.6, "wash_wobble": 7.0, "wash_pooling": 0.75,
    "wash_uneven": 1.8, "wash_size": 160.0, "wash_granulation": 0.1, "wash_gaps": 0.5,
    "wash_paper": (0.985, 0.975, 0.95), "wash_seed": 0,
    # rim light
    "use_rim": False, "rim_width": 8.0, "rim_facing": 0.8, "rim_space": "PICTURE",
    "rim_angle": 135.0, "rim_elevation": 30.0, "rim_spread": 180.0,
    "rim_softness": 0.0, "rim_color": (1.0, 1.0, 1.0), "rim_tint": 0.0, "rim_strength": 1.0,
    # specks
    "use_specks": False, "speck_size": 4.0,
    # print
    "use_relief": False, "paper_relief": 0.4, "paper_under": 0.5, "paper_under_color": (0.90, 0.84, 0.72),
    "use_print": False, "print_inks": "FOUR", "print_dark": (0.02, 0.035, 0.12), "print_light": (0.95, 0.30, 0.16),
    "print_paper": (0.93, 0.89, 0.80), "print_pitch": 7.0, "print_black": 0.5,
    "print_least": 0.06,
    # read before the layers reach the stages
    "object_index": "AUTO", "shade_light": "ALL", "layer_source": "CYCLES", "light_source": "CYCLES",
    "world_shadows": False, "world_planes": 0.0, "facet_angle": 0.0, "flat_colors": 0, "sky_colors": 16,
    "light_denoise": "OIDN",
    "save_layers": "AUTO", "save_rest": "AUTO",
}

ENGINE = {"object_index", "shade_light", "layer_source", "light_source", "world_shadows", "world_planes", "facet_angle",
          "flat_colors", "sky_colors", "light_denoise", "save_layers", "save_rest"}
SWITCHES = ("use_lines", "use_shading", "use_smudging", "use_hatching", "use_tones", "use_rim", "use_wash",
            "use_gouache", "use_specks", "use_print", "use_relief")

_CREASES = {"flush_pieces", "crease_angle", "crease_angle_smooth", "crease_bumps"}
_PARTS = {"light_hue", "other_highlights", "other_reflections", "other_glow", "reflection_tones", "highlight_shape",
          "highlight_threshold", "highlight_color"}
_FRAMES = {"shade_meter", "meter_light", "meter_shade", "tone_sky", "tone_detail", "tone_least", "tone_black_widest",
           "tone_crumbs", "line_search",
           "line_thickest", "line_occlude",
           "wash_size", "wash_paper", "wash_seed", "gouache_size"}


def is_surface(name):
    """Whether a style may change the parameter `name`; all others belong to the frame."""
    if name in _FRAMES:
        return False
    if name in _PARTS:
        return True
    return name in _CREASES or name.startswith(
        ("line_", "pen_", "ink_", "shade_", "hatch_", "smudge_", "tone_", "rim_", "wash_", "gouache_", "example_",
         "speck_", "print_", "use_"))


class Params:
    """The scene's and its styles' values: `p["id"]` of frame scope, `p.at("id", style)` of surface scope."""

    def __init__(self, scene, styles):
        scene, styles = dict(scene or {}), [dict(style) for style in styles]
        for name in {name for values in [scene, *styles] for name in values}:
            if name not in DEFAULTS:
                raise ValueError(f"there is no parameter {name!r}")
        base = {**DEFAULTS, **scene}
        own = [{name: value for name, value in style.items() if is_surface(name)} for style in styles]
        self.tables = [base, *({**base, **values} for values in own)]

    def __getitem__(self, name):
        assert not is_surface(name), f"{name} is a style's"
        return self.tables[0][name]

    def at(self, name, style):
        """Values of `name` for a map of style numbers: the map's shape, and (…, 3) for a colour."""
        assert is_surface(name), f"{name} is the frame's"
        return np.array([table[name] for table in self.tables])[style]

    def of(self, style):
        """{name: value} of one style."""
        return self.tables[style]

    def levels(self):
        """(style number, its shade_levels) for the scene and each style."""
        return [(k, table["shade_levels"]) for k, table in enumerate(self.tables)]

    def pixels(self, full_height):
        """Pixels in one unit of length."""
        if self["length_unit"] == "PIXELS":
            return float(self["supersample"])
        return full_height / (self["page_height"] if self["length_unit"] == "MM" else 1080.0)
