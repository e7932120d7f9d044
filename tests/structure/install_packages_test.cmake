# tools/install-packages on a machine where another apt holds the lists: with programs in the place of
# apt-get, dpkg-query and sudo that write down how they are called.
set(programs ${WORK}/install_packages)
file(REMOVE_RECURSE ${programs})
function(program name text)
  file(WRITE ${programs}/${name} "#!/usr/bin/env bash\n${text}")
  file(CHMOD ${programs}/${name} PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE)
endfunction()

program(dpkg-query "exit 1\n")
program(sudo "exec \"$@\"\n")
program(apt-get [=[
echo "$*" >> "$CALLS"
[[ "$*" != *" install "* && $(grep -c " update$" "$CALLS") -le 2 ]] || exit 0
echo "E: ${TROUBLE:-Could not get lock /var/lib/apt/lists/lock. It is held by process 1}" >&2
exit 100
]=])

function(run trouble)
  file(REMOVE ${programs}/calls)
  execute_process(
    COMMAND ${CMAKE_COMMAND} -E env "PATH=${programs}:$ENV{PATH}" CALLS=${programs}/calls
      "TROUBLE=${trouble}" ${SOURCE_DIR}/tools/install-packages
    RESULT_VARIABLE code ERROR_VARIABLE errors)
  set(code ${code} PARENT_SCOPE)
  set(errors ${errors} PARENT_SCOPE)
  file(STRINGS ${programs}/calls calls)
  set(calls ${calls} PARENT_SCOPE)
endfunction()

run("")
list(LENGTH calls count)
if(NOT code EQUAL 0 OR NOT count EQUAL 4 OR NOT errors MATCHES "waits for another apt")
  message(FATAL_ERROR "it does not wait until the lists are free (${code}): ${calls}\n${errors}")
endif()
list(GET calls 3 install)
if(NOT install MATCHES "DPkg::Lock::Timeout=[1-9][0-9]+ install --yes")
  message(FATAL_ERROR "apt-get install is not told to wait: ${install}")
endif()

run("The repository is not signed.")
list(LENGTH calls count)
if(code EQUAL 0 OR NOT count EQUAL 1 OR NOT errors MATCHES "not signed")
  message(FATAL_ERROR "it hides what is wrong (${code}): ${calls}\n${errors}")
endif()
