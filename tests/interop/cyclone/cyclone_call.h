/* SPDX-License-Identifier: Apache-2.0
 * One call of a service, from a client that is made for it. */
#ifndef CYCLONE_CALL_H
#define CYCLONE_CALL_H
#include "cyclone_requests.h"
#include "dds/dds.h"
#include <string.h>

/* Sends one request of a service and waits for its reply; the caller reads the body and may leave
 * the loan. */
void* call(const char* node, const char* package, const char* service, const char* path,
           const dds_topic_descriptor_t* request_type, const dds_topic_descriptor_t* reply_type,
           const void* request);

/* `request` is a cyclone_requests_<service>Request; the reply is read by the caller. */
#define CALL(package, service, path, request)                                     \
  call(node, #package, #service, path, &cyclone_requests_##service##Request_desc, \
       &cyclone_requests_##service##Reply_desc, request)
/* A request with nothing in it but who asks. */
#define REQUEST(service, name)              \
  cyclone_requests_##service##Request name; \
  memset(&name, 0, sizeof name);            \
  name.guid = 0x0123456789abcdefULL;        \
  name.number = 77
#endif
