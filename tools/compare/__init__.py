# SPDX-License-Identifier: GPL-3.0-or-later
"""`encre compare`: a benchmark of ways to draw lines, which artists need not install."""
