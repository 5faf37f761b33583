"""Categories of matter in specifications: models, audit, estimates and all else that is special to one."""
