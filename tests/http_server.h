/* SPDX-License-Identifier: GPL-3.0-or-later */
/* http_server - a server on 127.0.0.1 for tests of downloads, which does what the first part of a path says. It knows
 * one MERL table by any name, and files of its directory. Each connection has a process of its own. */
#ifndef HTTP_SERVER_H
#define HTTP_SERVER_H

#include <arpa/inet.h>
#include <fcntl.h>
#include <signal.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <unistd.h>

enum { HTTP_TABLE_SIZE = 34992012, HTTP_CUT = 12000000 };

/* The table: a sound header, then bytes that differ from place to place, so that one put together wrongly shows. */
static unsigned char http_table[HTTP_TABLE_SIZE];

static inline void http_table_fill(void)
{
	static const unsigned char header[12] = {90, 0, 0, 0, 90, 0, 0, 0, 180, 0, 0, 0};
	uint32_t x = 1;
	for (size_t i = 0; i < sizeof http_table; i++) {
		x = x * 1664525u + 1013904223u;
		http_table[i] = (unsigned char)(x >> 24);
	}
	memcpy(http_table, header, sizeof header);
}

struct http_reply {
	const char *status;
	const unsigned char *body;
	size_t size;     /* of the body */
	size_t declared; /* Content-Length */
	size_t first;    /* of the bytes sent */
	size_t last;     /* behind the last byte sent */
	bool ranges;     /* honour what was asked for */
};

static inline bool http_send(int fd, const void *data, size_t size)
{
	for (const char *at = data; size;) {
		const ssize_t n = write(fd, at, size);
		if (n <= 0)
			return false;
		at += n;
		size -= (size_t)n;
	}
	return true;
}

static inline void http_answer(int fd, struct http_reply r, size_t from, bool ranged)
{
	char head[512];
	if (ranged && r.ranges && from >= r.size) {
		r = (struct http_reply){.status = "416 Range Not Satisfiable", .body = (const unsigned char *)""};
	} else if (ranged && r.ranges) {
		r.status = "206 Partial Content";
		r.first = from;
		r.declared -= from;
		r.last = r.last + from > r.size ? r.size : r.last + from;
		snprintf(head, sizeof head,
			 "HTTP/1.1 %s\r\nContent-Range: bytes %zu-%zu/%zu\r\nContent-Length: %zu\r\n"
			 "Connection: close\r\n\r\n",
			 r.status, from, r.size - 1, r.size, r.declared);
		if (http_send(fd, head, strlen(head)))
			http_send(fd, r.body + r.first, r.last - r.first);
		return;
	}
	snprintf(head, sizeof head, "HTTP/1.1 %s\r\nContent-Length: %zu\r\nConnection: close\r\n\r\n", r.status,
		 r.declared);
	if (http_send(fd, head, strlen(head)))
		http_send(fd, r.body, r.last);
}

static inline void http_redirect(int fd, const char *to, const char *name)
{
	char head[512];
	snprintf(head, sizeof head,
		 "HTTP/1.1 302 Found\r\nLocation: /%s/%s\r\nContent-Length: 0\r\nConnection: close\r\n\r\n", to, name);
	http_send(fd, head, strlen(head));
}

static inline struct http_reply http_page(const char *status, const char *page)
{
	const size_t n = strlen(page);
	return (struct http_reply){status, (const unsigned char *)page, n, n, 0, n, false};
}

/* A file of the server's directory, all of it in memory. */
static inline struct http_reply http_file(const char *name)
{
	struct stat info;
	const int fd = open(name, O_RDONLY);
	if (fd < 0 || fstat(fd, &info))
		return http_page("404 Not Found", "<html>no such page</html>");
	const size_t n = (size_t)info.st_size;
	unsigned char *body = malloc(n + 1);
	if (!body || read(fd, body, n) != (ssize_t)n)
		_exit(1);
	return (struct http_reply){"200 OK", body, n, n, 0, n, true};
}

static inline void http_endless(int fd)
{
	static const char head[] = "HTTP/1.1 200 OK\r\nConnection: close\r\n\r\n";
	bool sent = http_send(fd, head, sizeof head - 1) && http_send(fd, http_table, sizeof http_table);
	while (sent)
		sent = http_send(fd, http_table, sizeof http_table);
}

/* What each place does. */
static inline void http_serve(int fd, const char *place, const char *name, size_t from, bool ranged)
{
	const size_t n = sizeof http_table;
	struct http_reply table = {"200 OK", http_table, n, n, 0, n, true};
	if (!strcmp(place, "good")) {
		http_answer(fd, table, from, ranged);
	} else if (!strcmp(place, "cut")) {
		table.last = HTTP_CUT;
		http_answer(fd, table, from, ranged);
	} else if (!strcmp(place, "dead")) {
		table.last = 1000;
		if (!ranged)
			http_answer(fd, table, 0, false);
	} else if (!strcmp(place, "stuck")) {
		table.last = 1000000;
		http_answer(fd, table, from, ranged);
		pause();
	} else if (!strcmp(place, "norange")) {
		table.ranges = false;
		http_answer(fd, table, from, ranged);
	} else if (!strcmp(place, "long")) {
		table.declared += 1000;
		http_answer(fd, table, from, ranged);
	} else if (!strcmp(place, "short")) {
		table.declared = 1000;
		table.ranges = false;
		http_answer(fd, table, from, ranged);
	} else if (!strcmp(place, "wrong")) {
		http_table[0] = 91;
		http_answer(fd, table, from, ranged);
	} else if (!strcmp(place, "html")) {
		http_answer(fd, http_page("200 OK", "<html>log in first</html>"), from, ranged);
	} else if (!strcmp(place, "error")) {
		http_answer(fd, http_page("503 Service Unavailable", "<html>later</html>"), from, ranged);
	} else if (!strcmp(place, "moved")) {
		http_redirect(fd, "good", name);
	} else if (!strcmp(place, "loop")) {
		http_redirect(fd, "loop", name);
	} else if (!strcmp(place, "endless")) {
		http_endless(fd);
	} else if (!strcmp(place, "silent")) {
		pause();
	} else if (!strcmp(place, "file") || !strcmp(place, "cutfile")) {
		struct http_reply file = http_file(name);
		if (place[0] == 'c' && file.last > HTTP_CUT)
			file.last = HTTP_CUT;
		http_answer(fd, file, from, ranged);
	} else if (!strcmp(place, "mixed")) {
		/* Not the same with every material. */
		http_serve(fd,
			   !strncmp(name, "brass", 5)    ? "nowhere"
			   : !strncmp(name, "chrome", 6) ? "html"
							 : "cut",
			   name, from, ranged);
	} else {
		http_answer(fd, http_page("404 Not Found", "<html>no such page</html>"), from, ranged);
	}
}

static inline void http_connection(int fd, int log)
{
	char request[4096], place[64] = "", name[256] = "";
	size_t length = 0, from = 0;
	ssize_t n;
	while (length < sizeof request - 1 && (n = read(fd, request + length, sizeof request - 1 - length)) > 0) {
		length += (size_t)n;
		request[length] = '\0';
		if (strstr(request, "\r\n\r\n"))
			break;
	}
	request[length] = '\0';
	if (sscanf(request, "GET /%63[^/ ]/%255[^ ?]", place, name) != 2)
		return;
	const char *range = strstr(request, "Range: bytes=");
	if (range)
		from = (size_t)strtoull(range + strlen("Range: bytes="), NULL, 10);
	dprintf(log, "%s/%s %zu\n", place, name, from);
	http_serve(fd, place, name, from, range);
}

struct http_server {
	pid_t pid;
	int port;
};

/* http_start - serves until http_stop() or the end of the caller. Each request is a line "place/name first-byte" in the
 * file `log`. port 0: failed. */
static inline struct http_server http_start(const char *log)
{
	struct sockaddr_in address = {.sin_family = AF_INET, .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
	socklen_t size = sizeof address;
	struct http_server server = {.pid = -1};
	const int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
	if (fd < 0 || bind(fd, (struct sockaddr *)&address, sizeof address) || listen(fd, 16) ||
	    getsockname(fd, (struct sockaddr *)&address, &size))
		return server;
	http_table_fill();
	server.pid = fork();
	if (server.pid == 0) {
		prctl(PR_SET_PDEATHSIG, SIGKILL);
		signal(SIGCHLD, SIG_IGN);
		signal(SIGPIPE, SIG_IGN);
		const int requests = open(log, O_WRONLY | O_CREAT | O_APPEND, 0666);
		for (int connection; (connection = accept(fd, NULL, NULL)) >= 0; close(connection))
			if (fork() == 0) {
				prctl(PR_SET_PDEATHSIG, SIGKILL);
				http_connection(connection, requests);
				_exit(0);
			}
		_exit(1);
	}
	close(fd);
	server.port = server.pid > 0 ? ntohs(address.sin_port) : 0;
	return server;
}

static inline void http_stop(struct http_server *server)
{
	if (server->pid > 0)
		kill(server->pid, SIGKILL);
	server->pid = -1;
}

#endif
