"""AgenticSimBench and the headless harness: tasks, agents, isolation, budgets and scores on Inspect AI."""
