"""Drawings as SVG without a script: lines over axes, exponents, gaps, cuts. Each in every form that a page needs."""

import logging

# matplotlib tells at length, and in its own words, that a home which cannot be written to holds no cache of its fonts
logging.getLogger("matplotlib").setLevel(logging.ERROR)
