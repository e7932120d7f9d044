#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# compile_anew.sh COMPILER [ARGUMENT ...]: compiles without the output of last time. g++ reads the
# set of headers that lies there for the one it is to make, and makes another one of it: no two
# checkouts would share what is compiled with it.
before=''
for argument in "$@"; do
  [ "$before" != -o ] || rm -f -- "$argument"
  before="$argument"
done
exec "$@"
