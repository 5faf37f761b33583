"""Floor 6: what tools share: sessions, jobs, gates between steps, bundles, reports, measurements, estimates."""
