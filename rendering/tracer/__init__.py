"""The path tracer (Mitsuba): scenes, materials, light, radiance to pictures."""
