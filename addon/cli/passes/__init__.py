# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of other renderers: what in them is what.

In: names and metadata of an EXR's channels. Out: passes as composite reads them. renderers knows what others call
theirs, mattes reads Cryptomatte, substitutes stand in for what is not there and tell what its lack switches off.
"""
