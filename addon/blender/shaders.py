# SPDX-License-Identifier: GPL-3.0-or-later
"""Shaders -> what a surface looks like: a part of nodes.Compiler."""

from dataclasses import dataclass

from ..pen.program import Register
from . import versions
from .inputs import Inputs

# What light loses that leaves rough facets (GGX) once, for others of them are in its way, fitted to integrals: rows by
# powers of the roughness from 2 on, columns of the cosine of where it is looked at from; and in the mean of all sides,
# by powers from 3 on. Colors that are made of it are .006 away at most, where that cosine is above .3.
_LOST = (2.4704, -6.2853, 2.9279), (-5.2773, 18.1391, -9.47), (3.011, -11.0058, 6.1833)
_LOST_ON_AVERAGE = 0.2894, 3.117, -4.4391, 1.6239
_MATT = 0.6, 0.9  # how rough a metal is that begins to be matt, and one that is
_TINT = 0.02    # differences of color that nobody sees
_ROUGH = 0.35   # from where on it tells how it is looked at


@dataclass
class Surface:
    """Colours by threes, alpha and roughness, of numbers and registers. Where something shows through, colours are
    those of the share that does not."""

    color: tuple = (0.0, 0.0, 0.0)
    gloss: tuple = (0.0, 0.0, 0.0)
    emission: tuple = (0.0, 0.0, 0.0)
    alpha: object = 1.0
    roughness: object = 1.0
    shine: tuple = (0.0, 0.0, 0.0)   # of highlights, where they are looked at from above
    shine_roughness: object = 0.0
    coat: object = 0.0               # likewise, of what lies above it
    coat_roughness: object = 0.0
    turned: tuple = (0.0, 0.0, 0.0)  # where light takes it to face; 0: where the mesh does
    holdout: object = 0.0            # the share that is a hole in the picture


class Shaders(Inputs):
    """A Surface of each output, by names."""

    def _BsdfDiffuse(self, node):
        return {"BSDF": Surface(self.three(node.inputs["Color"]))}

    _BsdfToon = _BsdfTranslucent = _BsdfDiffuse

    def _BsdfHair(self, node):
        self.lose(node.name)  # it is darker where it is smooth
        return self._BsdfDiffuse(node)

    def _BsdfHairPrincipled(self, node):
        """The colour that light takes on which goes through it (Chiang et al., A Practical and Controllable Hair and
        Fur Model, 2016, equation 9; melanins by d'Eon et al. 2011)."""
        self.lose(node.name)  # Cycles counts its highlights as color
        build, inputs = self.build, node.inputs
        if node.parametrization == "COLOR":
            return {"BSDF": Surface(self.three(inputs["Color"]))}
        tint = (1.0,) * 3
        if node.parametrization == "ABSORPTION":
            absorbed = self.three(inputs["Absorption Coefficient"])
        else:
            left = build.maximum(build.subtract(1.0, self.number(inputs["Melanin"])), 1e-4)
            amount = self._negative(build.apply("logarithm", left))
            red = build.multiply(amount, build.clamp(self.number(inputs["Melanin Redness"])))
            absorbed = tuple(build.add(build.multiply(brown, build.subtract(amount, red)), build.multiply(of_red, red))
                             for brown, of_red in zip((0.506, 0.841, 1.653), (0.343, 0.733, 1.924), strict=True))
            tint = self.three(inputs["Tint"])
        rough = build.clamp(self.number(inputs["Radial Roughness"]))
        way = self._powers(rough, (5.969, -0.215, 2.532, -10.73, 5.574, 0.245))
        return {"BSDF": Surface(tuple(
            build.multiply(hue, self._exponential(self._negative(build.multiply(
                way, build.apply("root", build.maximum(c, 0.0)))))) for hue, c in zip(tint, absorbed, strict=True)))}

    def _powers(self, x, factors):
        """A polynomial, its factors from the constant one up."""
        total = 0.0
        for factor in reversed(factors):
            total = self.build.add(self.build.multiply(total, x), factor)
        return total

    def _BsdfSheen(self, node):
        self.lose(node.name)  # it is darker, and brighter where it turns away
        return self._BsdfDiffuse(node)

    _BsdfVelvet = _BsdfSheen

    def _SubsurfaceScattering(self, node):
        return {"BSSRDF": Surface(self.three(node.inputs["Color"]))}

    def _BsdfGlossy(self, node):
        rough, color = self._roughness(node), self.three(node.inputs["Color"])
        gloss, shine = self._among_facets(node, color, color, rough)
        return {"BSDF": Surface(gloss=gloss, roughness=rough, shine=shine, shine_roughness=rough)}

    def _mean_mirrored(self, color, tint):
        """What a metal mirrors in the mean of all sides: more than from above, and less of a tint at 82 degrees (Kutz
        et al., Novel Aspects of the Adobe Standard Material, 2023)."""
        build = self.build
        return self._each(lambda c, t: build.subtract(build.mix(c, 1.0, 1 / 21), build.multiply(
            0.14009, build.multiply(build.mix(c, 1.0, 0.46266), build.subtract(1.0, t)))), color, tint)

    def _among_facets(self, node, color, mean, rough):
        """(colour, colour of highlights) of what mirrors as metals do, with the light that goes from facet to facet
        and takes their colour each time (Kulla and Conty, Revisiting Physically Based Shading, 2017). mean: what it
        mirrors in the mean of all sides."""
        if any(self.number(node.inputs[name]) != 0 for name in ("Anisotropic", "Anisotropy") if name in node.inputs):
            self.lose(node.name)
        if getattr(node, "distribution", "GGX") != "MULTI_GGX" or not versions.FACETS_TINT:
            return color, color
        build, cosine = self.build, 1.0
        if isinstance(rough, Register) or rough > _ROUGH:
            cosine = build.apply("absolute", self._dot_of(build.run("normal"), build.run("incoming")))
        lost = self._powers(rough, (0.0, 0.0, *(self._powers(cosine, row) for row in _LOST)))
        kept = build.maximum(build.subtract(1.0, build.maximum(lost, 0.0)), 0.05)
        again = build.divide(build.subtract(1.0, kept), kept)
        less = self._powers(rough, (0.0,) * 3 + _LOST_ON_AVERAGE)

        def more(c):
            few = build.divide(build.multiply(c, build.subtract(1.0, less)),
                               build.subtract(1.0, build.multiply(c, less)))
            return build.add(1.0, build.multiply(few, again))
        shine = self._each(lambda c, m: build.multiply(c, more(m)), color, mean)
        return tuple(build.multiply(c, kept) for c in shine), shine

    def _roughness(self, node):
        return self.build.clamp(self.number(node.inputs["Roughness"]))

    _BsdfAnisotropic = _BsdfGlossy  # what Glossy is called since 4.0

    def _BsdfMetallic(self, node):
        if node.fresnel_type != "F82":
            self.lose(node.name)
        rough, color = self._roughness(node), self.three(node.inputs["Base Color"])
        mean = self._mean_mirrored(color, self.three(node.inputs["Edge Tint"]))
        gloss, shine = self._among_facets(node, color, mean, rough)
        return {"BSDF": Surface(gloss=gloss, roughness=rough, shine=shine, shine_roughness=rough)}

    def _BsdfGlass(self, node):
        self.through = True
        color, rough = self.three(node.inputs["Color"]), self._roughness(node)
        level = self._mirrors(self.number(node.inputs["IOR"]))
        return {"BSDF": Surface(gloss=color, roughness=rough, shine_roughness=rough,
                                shine=tuple(self.build.multiply(c, level) for c in color))}

    def _BsdfRefraction(self, node):
        self.through = True
        return {"BSDF": Surface(gloss=self.three(node.inputs["Color"]), roughness=self._roughness(node))}

    def _mirrors(self, ior):
        """The share of light that a smooth surface mirrors which it meets straight from above."""
        build = self.build
        root = build.divide(build.subtract(ior, 1.0), build.add(ior, 1.0))
        return build.multiply(root, root)

    def _BsdfTransparent(self, node):
        color = self.three(node.inputs["Color"])
        if any(isinstance(c, Register) for c in color) or max(color) - min(color) > _TINT:
            self.lose(node.name)  # what is behind it has a tint
        most = self.build.maximum(color[0], self.build.maximum(color[1], color[2]))
        return {"BSDF": Surface(alpha=self.build.clamp(self.build.subtract(1.0, most)))}

    def _Holdout(self, node):
        return {"Holdout": Surface(holdout=1.0)}

    def _Emission(self, node):
        strength = self.number(node.inputs["Strength"])
        glow = Surface(emission=tuple(self.build.multiply(c, strength) for c in self.three(node.inputs["Color"])))
        return {"Emission": glow, "Background": glow}

    _Background = _Emission

    def _BsdfRayPortal(self, node):
        self.lose(node.name)
        return {"BSDF": Surface(alpha=0.0)}

    def _EeveeSpecular(self, node):
        """EEVEE's own."""
        build, inputs = self.build, node.inputs
        alpha = build.clamp(build.subtract(1.0, self.number(inputs["Transparency"])))
        base, shine, glow = (self.three(inputs[name]) for name in ("Base Color", "Specular", "Emissive Color"))
        rough = self._roughness(node)
        return {"BSDF": Surface(*(tuple(build.multiply(c, alpha) for c in color) for color in (base, (0.0,) * 3, glow)),
                                alpha, rough, tuple(build.multiply(c, alpha) for c in shine), rough)}

    def _ShaderToRGB(self, node):
        """EEVEE's own: what light makes of a surface, as a colour. Cycles knows it not."""
        build, surface = self.build, self.shader(node.inputs["Shader"])
        light = self._light()
        lit = self._each(lambda matt, gloss, by: build.multiply(build.add(matt, gloss), by),
                         surface.color, surface.gloss, light)
        return {"Color": self._each(build.add, lit, surface.emission), "Alpha": surface.alpha}

    def _BsdfPrincipled(self, node):
        build, inputs = self.build, node.inputs

        def named(*names):
            return next(inputs[name] for name in names if name in inputs)

        base, metal = self.three(inputs["Base Color"]), build.clamp(self.number(inputs["Metallic"]))
        through = build.clamp(self.number(named("Transmission Weight", "Transmission")))
        alpha = build.clamp(self.number(inputs["Alpha"]))
        self.through |= through != 0
        matt = build.multiply(alpha, build.multiply(build.subtract(1.0, metal), build.subtract(1.0, through)))
        other = build.subtract(alpha, matt)
        strength = build.multiply(self.number(inputs["Emission Strength"]), alpha)
        glow = (0.0,) * 3 if strength == 0 else self.three(named("Emission Color", "Emission"))
        rough = self._roughness(node)
        metallic = gleam = base
        if metal != 0:
            edge = self.three(inputs["Specular Tint"]) if inputs["Specular Tint"].type == "RGBA" else (1.0,) * 3
            metallic, gleam = self._among_facets(node, base, self._mean_mirrored(base, edge), rough)
        mirrored = build.multiply(alpha, metal)
        other = build.subtract(other, mirrored)
        # A metal so rough mirrors nothing that is told apart: it is matt, as light falls on it, and has no highlights.
        dull = build.clamp(build.multiply(build.subtract(rough, _MATT[0]), 1 / (_MATT[1] - _MATT[0])))
        dull = build.multiply(mirrored, dull)
        mirrored = build.subtract(mirrored, dull)
        gleams = build.subtract(metal, dull)
        if "Specular IOR Level" in inputs:  # since 4.0
            level = build.multiply(self._mirrors(self.number(inputs["IOR"])),
                                   build.multiply(2.0, self.number(inputs["Specular IOR Level"])))
            shine = tuple(build.multiply(c, level) for c in self.three(inputs["Specular Tint"]))
            coat = build.multiply(self.number(inputs["Coat Weight"]), self._mirrors(self.number(inputs["Coat IOR"])))
        else:
            shine = (build.multiply(0.08, self.number(inputs["Specular"])),) * 3
            coat = build.multiply(0.01, self.number(inputs["Clearcoat"]))  # a quarter of what glass has
        return {"BSDF": Surface(tuple(build.add(build.multiply(c, matt), build.multiply(m, dull))
                                      for c, m in zip(base, metallic, strict=True)),
                                tuple(build.add(build.multiply(c, other), build.multiply(m, mirrored))
                                      for c, m in zip(base, metallic, strict=True)),
                                tuple(build.multiply(c, strength) for c in glow), alpha, rough,
                                tuple(build.multiply(alpha, c) for c in self._mixed(shine, gleam, gleams)), rough,
                                build.multiply(alpha, coat),
                                build.clamp(self.number(named("Coat Roughness", "Clearcoat Roughness"))))}

    def _MixShader(self, node):
        share = self.build.clamp(self.number(node.inputs[0]))
        if share in (0.0, 1.0):
            return {"Shader": self.shader(node.inputs[1 + int(share)])}
        a, b = (self.shader(node.inputs[k]) for k in (1, 2))
        mix = self.build.mix
        return {"Shader": Surface(*(self._mixed(getattr(a, name), getattr(b, name), share)
                                    for name in ("color", "gloss", "emission")),
                                  *(mix(getattr(a, name), getattr(b, name), share) for name in ("alpha", "roughness")),
                                  self._mixed(a.shine, b.shine, share), self._of_both(a, b, "shine", share),
                                  mix(a.coat, b.coat, share), self._of_both(a, b, "coat", share),
                                  self._turned(a, b, share), mix(a.holdout, b.holdout, share))}

    def _turned(self, a, b, share=0.5):
        """Where both shaders together face: those that show nothing do not count, nor what only shines beside what has
        a colour, as light falls on that."""
        none = (0.0,) * 3
        seen = [s.turned for s in (a, b) if s.color != none] or [
            s.turned for s in (a, b) if any(part != none for part in (s.gloss, s.emission, s.shine))]
        if len(set(seen)) < 2:
            return seen[0] if seen else none
        return self._mixed(*(self.build.run("normal") if way == none else way for way in seen), share)

    def _of_both(self, a, b, what, share=0.5):
        """How rough highlights of two shaders are: those that one of them has are as rough as its own."""
        one, other = (getattr(surface, what + "_roughness") for surface in (a, b))
        for surface, rough in ((a, other), (b, one)):
            if getattr(surface, what) in (0.0, (0.0,) * 3):
                return rough
        return self.build.mix(one, other, share)

    def _AddShader(self, node):
        a, b = (self.shader(node.inputs[k]) for k in (0, 1))
        add = self.build.add
        # Light that goes through one goes through both.
        alpha = self.build.clamp(self.build.subtract(add(a.alpha, b.alpha), 1.0))
        color, emission = self._each(add, a.color, b.color), self._each(add, a.emission, b.emission)
        if alpha == 0.0:  # nothing is there that light could fall on: added as in full light
            color, emission = (0.0,) * 3, self._each(add, emission, color)
        return {"Shader": Surface(color, self._each(add, a.gloss, b.gloss), emission, alpha,
                                  self.build.minimum(a.roughness, b.roughness),
                                  self._each(add, a.shine, b.shine), self._of_both(a, b, "shine"),
                                  add(a.coat, b.coat), self._of_both(a, b, "coat"), self._turned(a, b),
                                  self.build.clamp(add(a.holdout, b.holdout)))}
