# SPDX-License-Identifier: GPL-3.0-or-later
"""What other renderers call the passes that Encre reads.

To add: a row of PROFILES. Names are compared without case and without what is neither letter nor digit; of several that
a file has the first counts. TINTED ones are light with the surface's colour in it, from which that is divided out.
"""

import re

TINTED = {"DiffDir": "Tinted DiffDir", "DiffInd": "Tinted DiffInd"}

# Clear by themselves, whoever has rendered them.
_CLEAR = {
    "Combined": ("beauty", "RGBA", "Ci", "RGB_color", "main", "C"),
    "Depth": ("Z", "depth", "zdepth", "ZDepth"),
    "Normal": ("N", "normal", "normals", "Nn", "shading_normal"),
    "DiffCol": ("diffuse_albedo", "diffuse_filter", "albedo", "denoise_albedo", "base_color"),
}
# {renderer: (words in a file's metadata, names that no other has, {pass: names})}. The first names of all are _CLEAR.
PROFILES = {
    "renderman": (("renderman", "prman", "pixar"), ("Ci", "Nn", "directDiffuse", "__Nworld", "__depth", "z_filtered"), {
        "Depth": ("z", "__depth", "z_filtered", "zfiltered"), "Normal": ("Nn", "__Nworld", "normal"),
        "Tinted DiffDir": ("directDiffuse", "directDiffuseLobe"),
        "Tinted DiffInd": ("indirectDiffuse", "indirectDiffuseLobe"), "Emit": ("emissive",), "IndexOB": ("id",)}),
    "arnold": (("arnold", "mtoa", "htoa", "kick"), ("diffuse_direct", "diffuse_albedo", "specular_direct",
                                                    "crypto_object", "crypto_material", "shadow_matte"), {
        "Tinted DiffDir": ("diffuse_direct",), "Tinted DiffInd": ("diffuse_indirect",),
        "GlossCol": ("specular_albedo",), "TransCol": ("transmission_albedo",), "Emit": ("emission",),
        "IndexOB": ("ID",)}),
    "vray": (("v-ray", "vray", "chaos"), ("VRayDiffuseFilter", "VRayRawLighting", "VRayZDepth", "VRayNormals",
                                          "raw_light", "lighting_raw", "rawLighting", "rawGI", "gi_raw", "VRayMtlID",
                                          "VRayObjectID", "bump_normals", "self_illumination"), {
        "Depth": ("zDepth", "z_depth", "VRayZDepth"), "Normal": ("normals", "VRayNormals", "bump_normals"),
        "DiffCol": ("diffuse_filter", "VRayDiffuseFilter", "diffuse"),
        "DiffDir": ("raw_light", "lighting_raw", "raw_lighting", "VRayRawLighting"),
        "DiffInd": ("raw_gi", "gi_raw", "VRayRawGlobalIllumination"),
        "Tinted DiffDir": ("lighting", "VRayLighting"), "Tinted DiffInd": ("gi", "VRayGlobalIllumination"),
        "GlossCol": ("reflection_filter", "VRayReflectionFilter"), "TransCol": ("refraction_filter",
                                                                                "VRayRefractionFilter"),
        "Emit": ("self_illumination", "VRaySelfIllumination"), "IndexOB": ("object_id", "VRayObjectID", "node_id",
                                                                           "render_id"),
        "IndexMA": ("material_id", "mtl_id", "VRayMtlID")}),
    "redshift": (("redshift",), ("DiffuseLighting", "DiffuseLightingRaw", "GlobalIlluminationRaw", "SpecularLighting",
                                 "PuzzleMatte", "ObjectBumpNormals", "BumpNormals"), {
        "Normal": ("BumpNormals", "ObjectBumpNormals", "N", "Normals"), "DiffCol": ("DiffuseFilter",),
        "DiffDir": ("DiffuseLightingRaw",), "DiffInd": ("GlobalIlluminationRaw",),
        "Tinted DiffDir": ("DiffuseLighting",), "Tinted DiffInd": ("GlobalIllumination", "GI"),
        "GlossCol": ("ReflectionsFilter",), "TransCol": ("RefractionsFilter",), "Emit": ("Emission",),
        "IndexOB": ("ObjectID",), "IndexMA": ("MaterialID",)}),
    "karma": (("karma", "husk", "houdini"), ("C", "Pz", "hitPz", "hitN", "directdiffuse", "combineddiffuse",
                                             "directglossyreflection", "visiblelights", "primid"), {
        "Depth": ("Pz", "hitPz", "depth"), "Normal": ("N", "hitN"),
        "Tinted DiffDir": ("directdiffuse", "diffuse_direct"),
        "Tinted DiffInd": ("indirectdiffuse", "diffuse_indirect"),
        "GlossCol": ("specular_albedo",), "TransCol": ("transmission_albedo",),
        "Emit": ("emission", "directemission"), "IndexOB": ("primid", "prim_id")}),
    "octane": (("octane", "otoy"), ("ShadingNormal", "GeometricNormal", "SmoothNormal", "DiffuseFilter(info)",
                                    "ObjectLayer", "ObjectLayerMap", "RenderLayerID"), {
        "Depth": ("Z-Depth", "ZDepth"), "Normal": ("ShadingNormal", "Normal", "SmoothNormal", "GeometricNormal"),
        "DiffCol": ("DiffuseFilter(info)", "DiffuseFilter"), "Tinted DiffDir": ("DiffuseDirect",),
        "Tinted DiffInd": ("DiffuseIndirect",), "GlossCol": ("ReflectionFilter",), "TransCol": ("RefractionFilter",),
        "Emit": ("Emitters", "Emission"), "IndexOB": ("ObjectLayerMap", "ObjectLayer", "ObjectID"),
        "IndexMA": ("MaterialID",)}),
    "eevee": ((), (), {}),  # it has Cycles' names
    "compositor": ((), (), {  # the sockets of Blender's nodes, as File Output calls its layers
        "Combined": ("Image", "Noisy Image"), "Depth": ("Depth", "Z"), "Normal": ("Normal",),
        "DiffCol": ("Diffuse Color", "DiffCol"), "DiffDir": ("Diffuse Direct", "DiffDir"),
        "DiffInd": ("Diffuse Indirect", "DiffInd"), "GlossCol": ("Glossy Color",), "GlossDir": ("Glossy Direct",),
        "GlossInd": ("Glossy Indirect",), "TransCol": ("Transmission Color",), "Emit": ("Emission", "Emit"),
        "Env": ("Environment",), "IndexOB": ("Object Index",), "IndexMA": ("Material Index",)}),
}
_LEAST = 2  # names that no other renderer has, by which one is known


SINGLE = ("Depth", "IndexOB", "IndexMA")  # passes of one channel; some renderers save them as grey in R, G and B


def letter(full):
    """By which a pass's channels are sorted: some are called red, green and blue."""
    return "RGBAXYZ".find(full.rpartition(".")[2][:1].upper())


def one_of(fulls):
    """The channel of a pass of one channel."""
    return [next((full for full in fulls if full[-1] in "zZ"), fulls[0])]


def _plain(name):
    return re.sub(r"[^a-z0-9]", "", name.lower())


def _layers(channels, view=""):
    """{plain name: [full channel name …]}."""
    found = {}
    for full in channels:
        name = full.rpartition(".")[0]
        name = name.removesuffix(f".{view}") if view else name
        found.setdefault(_plain(name.rpartition(".")[2]), []).append(full)
    found.pop("", None)
    return found


def recognized(channels, metadata):
    """Which renderer a file is of, None where that is not clear."""
    layers = _layers(channels)
    sure = [name for name, (_, names, _) in PROFILES.items()
            if len({_plain(each) for each in names} & layers.keys()) >= _LEAST]
    if len(sure) == 1:
        return sure[0]
    words = " ".join(f"{key} {text[:200]}" for key, text in metadata.items() if "crypto" not in key).lower()
    told = [name for name, (known, _, _) in PROFILES.items() if any(word in words for word in known)]
    both = [name for name in told if name in sure] if sure else told
    return both[0] if len(both) == 1 else None


def named(renderer, channels, there, view=""):
    """{pass: [full channel name …]} of what a renderer (None: any) has and is not among the passes `there`."""
    layers, found = _layers(channels, view), {}
    profile = PROFILES[renderer][2] if renderer else {}
    for name in dict.fromkeys((*profile, *_CLEAR)):
        classic = next((own for own, tinted in TINTED.items() if tinted == name), name)
        if classic in there or classic in found:
            continue
        for one in (*profile.get(name, ()), *_CLEAR.get(name, ())):
            fulls = sorted(layers.get(_plain(one), ()), key=letter)
            if name in SINGLE and fulls:
                found[name] = one_of(fulls)
            elif len(fulls) >= 3:
                found[name] = fulls[:4 if name == "Combined" else 3]
            if name in found:
                break
    return found
