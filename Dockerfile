# imuwb in a container: the wheel is built in one stage, and only what runs is in the other.
#
#   docker build -t imuwb .
#   docker run --rm -v "$PWD":/data imuwb noise static.mcap
#
# The user is not root, and the compiled kernels are there already, so nothing has to be written beside the data.
FROM python:3.12-slim AS build
COPY . /source
RUN pip wheel --no-cache-dir --no-deps --wheel-dir /wheels /source

FROM python:3.12-slim
RUN useradd --create-home --uid 1000 imuwb
COPY --from=build /wheels /wheels
ENV NUMBA_CACHE_DIR=/opt/imuwb-cache PYTHONDONTWRITEBYTECODE=1
RUN pip install --no-cache-dir /wheels/imuwb-*.whl \
    && rm -r /wheels \
    && mkdir -p "$NUMBA_CACHE_DIR" \
    && imuwb warm \
    && chmod -R a+rX "$NUMBA_CACHE_DIR"
USER imuwb
WORKDIR /data
ENTRYPOINT ["imuwb"]
CMD ["--help"]
