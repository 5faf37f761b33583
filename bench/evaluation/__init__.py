"""AgenticSimBench: prompts, the harness that runs agents on them, and the paper's seven metrics."""
