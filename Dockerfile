# worldagent as a container: MCP over HTTP on port 8931, worlds in /worlds, no root.
#   docker build -t worldagent .                          # pictures and clearances on the processor
#   docker build -t worldagent:cuda --target cuda .       # on an NVIDIA GPU: docker run --gpus all ...
#   docker run -d --name worldagent -p 127.0.0.1:8931:8931 -e WORLDAGENT_TOKEN=... -v worlds:/worlds worldagent
# Clients that speak stdio: docker exec -i worldagent worldagent serve
FROM debian:bookworm-slim AS wheel
RUN apt-get update \
    && apt-get install -y --no-install-recommends python3 python3-venv \
    && rm -rf /var/lib/apt/lists/*
WORKDIR /src
COPY . .
RUN python3 -m venv /build \
    && /build/bin/pip install --no-cache-dir --constraint constraints.txt build \
    && /build/bin/python -m build --wheel --outdir /wheels .

FROM debian:bookworm-slim AS base
RUN apt-get update \
    && apt-get install -y --no-install-recommends python3 python3-venv libatomic1 libllvm19 tini \
    && rm -rf /var/lib/apt/lists/*
RUN useradd --create-home --uid 1000 agent && install -d -o agent -g agent -m 700 /worlds
COPY --from=wheel /wheels /wheels
COPY constraints.txt /wheels/
USER agent
WORKDIR /home/agent
RUN python3 -m venv venv && venv/bin/pip install --no-cache-dir --constraint /wheels/constraints.txt /wheels/*.whl
ENV PATH=/home/agent/venv/bin:$PATH WORLDAGENT_WORKSPACE=/worlds PYTHONSAFEPATH=1
# Compiles the kernels and proves the renderer, so that no first call waits for it; then every engine must work.
RUN worldagent warm && worldagent doctor
VOLUME /worlds
EXPOSE 8931
HEALTHCHECK --interval=30s --timeout=10s --start-period=30s \
    CMD ["python3", "-c", "import urllib.request; urllib.request.urlopen('http://127.0.0.1:8931/healthz', timeout=5)"]
# tini collects the workers of bakes, which outlive the servers that started them.
ENTRYPOINT ["tini", "--"]
CMD ["worldagent", "serve", "--transport", "http", "--host", "0.0.0.0", "--port", "8931", "--allow-host", "localhost", "--allow-host", "127.0.0.1"]

FROM base AS cuda
# Mitsuba needs the driver's OptiX (graphics), Warp its compiler (compute).
ENV WORLDAGENT_DEVICE=cuda NVIDIA_VISIBLE_DEVICES=all NVIDIA_DRIVER_CAPABILITIES=compute,graphics,utility

FROM base AS cpu
