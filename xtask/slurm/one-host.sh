#!/usr/bin/env bash
# A Slurm cluster on this machine alone, to try arrays on: a controller and two nodes of one core each.
#
#     one-host.sh up FOLDER      starts it with its state in FOLDER and prints the line to source
#     one-host.sh down FOLDER    ends it
#
# Needs root, and Debian's slurm-wlm and munge, which it installs where they are not there.
set -euo pipefail
[ $# -eq 2 ] || { printf 'usage: one-host.sh up|down FOLDER\n' >&2; exit 2; }
mkdir -p "$2"
state=$(cd "$2" && pwd)
export SLURM_CONF=$state/slurm.conf

down() {
    for pid in "$state"/*.pid; do
        [ -f "$pid" ] && kill "$(cat "$pid")" 2>/dev/null || true
    done
}

up() {
    if ! command -v slurmctld >/dev/null; then
        { apt-get update && DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends slurm-wlm munge; } \
            </dev/null >"$state/install.log" 2>&1 || { tail -5 "$state/install.log" >&2; exit 1; }
    fi
    # Who may talk to the cluster is told by a key that all its parts share.
    for folder in /run/munge /var/log/munge /var/lib/munge; do
        install -d -o munge -g munge -m 755 "$folder"
    done
    if [ ! -f /etc/munge/munge.key ]; then
        (umask 077 && head -c 1024 /dev/urandom >/etc/munge/munge.key)
        chown munge: /etc/munge/munge.key
    fi
    munge -n >/dev/null 2>&1 || su -s /bin/sh munge -c munged
    mkdir -p "$state/controller"
    local host nodes=""
    host=$(hostname -s)
    for n in 1 2; do
        mkdir -p "$state/node$n"
        nodes+="NodeName=node$n NodeHostname=$host NodeAddr=127.0.0.1 Port=$((17100 + n)) CPUs=1 State=UNKNOWN"$'\n'
    done
    cat >"$SLURM_CONF" <<CONF
ClusterName=alone
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
AuthType=auth/munge
StateSaveLocation=$state/controller
SlurmdSpoolDir=$state/%n
SlurmctldPidFile=$state/controller.pid
SlurmdPidFile=$state/%n.pid
SlurmctldLogFile=$state/controller.log
SlurmdLogFile=$state/%n.log
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
ReturnToService=2
AccountingStorageType=accounting_storage/none
JobAcctGatherType=jobacct_gather/none
# A task that is queued again need not wait.
KillWait=2
${nodes}PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
CONF
    slurmctld -f "$SLURM_CONF"
    for n in 1 2; do slurmd -N "node$n" -f "$SLURM_CONF"; done
    for _ in $(seq 30); do
        if sinfo --noheader --format %t 2>/dev/null | grep -q idle; then
            printf 'export SLURM_CONF=%s\n' "$SLURM_CONF"
            return
        fi
        sleep 1
    done
    tail -5 "$state"/*.log >&2
    exit 1
}

case $1 in
    up) up ;;
    down) down ;;
    *) printf 'one-host.sh: up or down, not %s\n' "$1" >&2; exit 2 ;;
esac
