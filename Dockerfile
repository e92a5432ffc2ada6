# The workbench without torch. In the folder of your logs:
#   docker build -t workbench PATH_OF_THE_CLONE
#   docker run --rm -v "$PWD:/data" workbench compare leg chirp.toml
FROM python:3.11-slim-bookworm
# glib for Drake, OpenMP for Pinocchio
RUN apt-get update \
    && apt-get install -y --no-install-recommends libglib2.0-0 libgomp1 make \
    && rm -rf /var/lib/apt/lists/*
COPY . /opt/workbench
RUN make -C /opt/workbench setup
WORKDIR /data
ENTRYPOINT ["/opt/workbench/.venv/bin/workbench"]
