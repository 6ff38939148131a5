"""The field of displacements that sticking fingers cause on the dome."""
