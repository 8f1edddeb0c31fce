# One image per service: docker build --build-arg SERVICE=negative --tag cliffscan-negative .
# For other processors: docker buildx build --platform linux/amd64,linux/arm64 …; both have wheels of everything.
# SERVICE is router, capture, negative, positive, fuse, perception, kobuki, gate or ros2; BASE any Debian with Python >= 3.11 and venv.
ARG BASE=python:3.11-slim
FROM $BASE

RUN useradd --create-home --uid 1000 cliffscan \
    && python -m venv /opt/cliffscan
ENV PATH=/opt/cliffscan/bin:$PATH PYTHONUNBUFFERED=1 PIP_NO_CACHE_DIR=1 PIP_DISABLE_PIP_VERSION_CHECK=1
WORKDIR /src

# Dependencies come from pyproject.toml alone, so that a change of the sources installs none of them again.
ARG PIP_INDEX_URL
ARG PIP_EXTRA_INDEX_URL
COPY pyproject.toml ./
RUN touch README.md LICENSE && pip install .

ARG SERVICE
RUN case "$SERVICE" in \
        router) pip install ".[secure]" ;; \
        capture) apt-get update \
            && apt-get install --yes --no-install-recommends libfreenect0.5 libopenni2-0 \
            && rm -rf /var/lib/apt/lists/* \
            && pip install ".[capture,simulator,secure]" ;; \
        negative|positive|fuse|perception|kobuki|gate|ros2) pip install ".[$SERVICE,secure]" ;; \
        *) echo "SERVICE is '$SERVICE', expected router, capture, negative, positive, fuse, perception, kobuki, gate or ros2" >&2; exit 1 ;; \
    esac

COPY . .
RUN pip install --no-deps --force-reinstall .

USER cliffscan
WORKDIR /home/cliffscan
# Compiled here, kernels start at once on processors of this kind; on others a service compiles them when it starts.
RUN case "$SERVICE" in negative|positive|perception) python -m cliffscan.compile ;; esac
ENV SERVICE=$SERVICE CLIFFSCAN_ALIVE_FILE=/tmp/alive
# The service keeps the file while it works, so a look costs no session.
HEALTHCHECK --interval=10s --timeout=5s --start-period=60s CMD ["test", "-e", "/tmp/alive"]
ENTRYPOINT ["sh", "-c", \
    "case $SERVICE in router) exec cliffscan router \"$@\" ;; *) exec cliffscan run $SERVICE \"$@\" ;; esac", "--"]
