"""Turns ``gel.yaml`` into what a person needs to make the gel: solids, stencil, drawings, a page."""
