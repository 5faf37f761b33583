# worldagent as a container: MCP over HTTP on port 8931, worlds in /worlds, no root.
#   docker build -t worldagent .
#   docker run -p 127.0.0.1:8931:8931 -e WORLDAGENT_TOKEN=... -v "$PWD/worlds:/worlds" worldagent
FROM debian:bookworm-slim AS base
RUN apt-get update \
    && apt-get install -y --no-install-recommends python3 python3-venv libllvm19 \
    && rm -rf /var/lib/apt/lists/*
RUN useradd --create-home --uid 1000 agent && mkdir /worlds && chown agent /worlds
COPY --chown=agent . /src
USER agent
WORKDIR /home/agent
RUN python3 -m venv venv && venv/bin/pip install --no-cache-dir --constraint /src/constraints.txt /src
ENV PATH=/home/agent/venv/bin:$PATH WORLDAGENT_WORKSPACE=/worlds PYTHONSAFEPATH=1
RUN worldagent warm
EXPOSE 8931
HEALTHCHECK --interval=30s --timeout=10s CMD python3 -c "import socket; socket.create_connection(('127.0.0.1', 8931), 5)"
CMD ["worldagent", "serve", "--transport", "http", "--host", "0.0.0.0", "--port", "8931"]
