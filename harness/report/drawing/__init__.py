"""Drawings as SVG without a script: lines over axes, exponents, gaps, cuts. Each in every form that a page needs."""
