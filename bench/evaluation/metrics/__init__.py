"""The seven metrics of AgenticSimBench, and the server's own figures beside them."""
