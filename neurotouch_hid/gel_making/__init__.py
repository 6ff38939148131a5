"""Turns ``gel.yaml`` into what a maker needs: solids, stencil, drawings, a page."""
