#!/bin/bash
# two_hosts.sh COMMAND...: runs COMMAND on host-a, where mpiexec can reach host-b: network namespaces with a cable
# between them. Each has a host name of its own, so that MPI takes them for two machines and has nothing but TCP.
#
# Called inside `unshare --net --uts`, as root or with `--user --map-root-user`; when it has ended all is gone.
set -euo pipefail

# host-b lives until this pipe is closed, which happens however this process ends.
exec {alive}> >(exec unshare --net --uts cat)
b=$!
until [ "$(readlink "/proc/$b/ns/uts")" != "$(readlink /proc/self/ns/uts)" ]; do sleep 0.01; done
on_b=(nsenter --target "$b" --net --uts)
hostname host-a
"${on_b[@]}" hostname host-b

ip link add cable type veth peer name cable netns "/proc/$b/ns/net"
ip address add 10.0.0.1/30 dev cable
"${on_b[@]}" ip address add 10.0.0.2/30 dev cable
for run in "" "${on_b[*]}"; do
  $run ip link set lo up
  $run ip link set cable up
done

# What Open MPI calls instead of ssh, with the host and the command line as words. Like ssh it passes no variables on.
own=$(mktemp -d)
trap 'until rm -rf "$own"; do sleep 0.1; done' EXIT  # host-b's daemon may still be clearing up in there
cat > "$own/agent" <<END
shift
exec ${on_b[*]} env --ignore-environment HOME="$HOME" PATH="$PATH" sh -c "\$*"
END
export OMPI_MCA_plm_rsh_agent="sh $own/agent" OMPI_MCA_plm=rsh OMPI_MCA_orte_tmpdir_base=$own
export OMPI_MCA_btl=tcp,self OMPI_MCA_btl_tcp_if_include=cable OMPI_MCA_oob_tcp_if_include=cable
# The same for Open MPI from 5 on.
export PRTE_MCA_plm_ssh_agent="sh $own/agent" PRTE_MCA_plm=ssh PRTE_MCA_prte_tmpdir_base=$own PRTE_MCA_prte_if_include=cable
"$@" {alive}>&-
