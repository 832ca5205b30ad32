/* SPDX-License-Identifier: GPL-3.0-or-later */
/* glsl - runs the part of GLSL that `stdfit export` writes: float, int, bool, vec2 (as .xy), vec3, constant arrays of
 * float, functions, if, for, break, return, ?:. Types are as strict as in GLSL 1.10: int and float do not mix. Arithmetic
 * is double, or rounded to float after every operation. Anything it does not know fails the test. */
#ifndef GLSL_H
#define GLSL_H

#include "check.h"
#include <ctype.h>

enum glsl_type { GLSL_VOID, GLSL_BOOL, GLSL_INT, GLSL_FLOAT, GLSL_VEC2, GLSL_VEC3, GLSL_ARRAY };

struct glsl_value {
	enum glsl_type type;
	double v[3];
	const double *array;
	int n;
};

/* What a node of the tree is. */
enum glsl_kind {
	GLSL_LITERAL,
	GLSL_NAME,
	GLSL_UNARY,
	GLSL_BINARY,
	GLSL_SELECT, /* ?: */
	GLSL_CALL,
	GLSL_INDEX,
	GLSL_FIELD,
	GLSL_DECLARE,
	GLSL_ASSIGN,
	GLSL_IF,
	GLSL_FOR,
	GLSL_RETURN,
	GLSL_BREAK,
	GLSL_BLOCK,
};

enum { GLSL_ITEMS = 40 };

struct glsl_node {
	enum glsl_kind kind;
	char name[32]; /* variable, function, operator, field */
	enum glsl_type type;
	struct glsl_value value;
	struct glsl_node **item;
	int n;
};

struct glsl_variable {
	char name[32];
	struct glsl_value value;
	bool constant;
};

struct glsl_function {
	char name[32];
	enum glsl_type returns;
	struct glsl_variable parameter[8];
	int n_parameters;
	struct glsl_node *body;
};

enum { GLSL_VARIABLES = 256, GLSL_FUNCTIONS = 64, GLSL_DEPTH = 40 };

struct glsl {
	const char *text, *at;
	char token[64];
	bool is_number, is_word;
	bool rounds; /* to float */
	struct glsl_function function[GLSL_FUNCTIONS];
	int n_functions;
	struct glsl_variable variable[GLSL_VARIABLES]; /* globals, then the locals of the running functions */
	int n_variables, n_globals, frame, depth;
	void *memory[20000]; /* all that was allocated */
	int n_memory;
	struct glsl_value returned;
};

static inline void *glsl_alloc(struct glsl *g, size_t size)
{
	void *memory = calloc(1, size);
	assert_non_null(memory);
	assert_true(g->n_memory < (int)(sizeof g->memory / sizeof *g->memory));
	return g->memory[g->n_memory++] = memory;
}

static inline void glsl_free(struct glsl *g)
{
	while (g->n_memory)
		free(g->memory[--g->n_memory]);
	free(g);
}

/* Through memory: gcc 12 at -O2 takes (double)(float) of two neighbours for nothing to do. */
static inline double glsl_to_float(double x)
{
	const volatile float rounded = (float)x;
	return (double)rounded;
}

static inline double glsl_round(const struct glsl *g, double x)
{
	return g->rounds ? glsl_to_float(x) : x;
}

/* Tokens */

static inline void glsl_fail(const struct glsl *g, const char *what)
{
	fail_msg("GLSL: %s at '%s', before: %.60s", what, g->token, g->at);
}

static inline void glsl_next(struct glsl *g)
{
	static const char *const pairs[] = {"<=", ">=", "==", "!=", "&&", "||", "+=", "-=", "*=", "/=", "++", "--"};
	size_t n = 0;

	for (;;) {
		g->at += strspn(g->at, " \t\r\n");
		if (strncmp(g->at, "//", 2) != 0)
			break;
		g->at += strcspn(g->at, "\n");
	}
	g->is_word = isalpha((unsigned char)*g->at) || *g->at == '_';
	g->is_number = isdigit((unsigned char)*g->at) || (*g->at == '.' && isdigit((unsigned char)g->at[1]));
	if (g->is_word) {
		while (isalnum((unsigned char)g->at[n]) || g->at[n] == '_')
			n++;
	} else if (g->is_number) {
		while (isalnum((unsigned char)g->at[n]) || g->at[n] == '.' ||
		       ((g->at[n] == '-' || g->at[n] == '+') && g->at[n - 1] == 'e'))
			n++;
	} else if (*g->at) {
		n = 1;
		for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++)
			if (!strncmp(g->at, pairs[i], 2))
				n = 2;
	}
	if (n >= sizeof g->token)
		fail_msg("GLSL: a token of %zu characters", n);
	memcpy(g->token, g->at, n);
	g->token[n] = '\0';
	g->at += n;
}

static inline bool glsl_is(const struct glsl *g, const char *token)
{
	return !strcmp(g->token, token);
}

static inline bool glsl_take(struct glsl *g, const char *token)
{
	if (!glsl_is(g, token))
		return false;
	glsl_next(g);
	return true;
}

static inline void glsl_expect(struct glsl *g, const char *token)
{
	if (!glsl_take(g, token))
		glsl_fail(g, token);
}

static inline void glsl_word(struct glsl *g, char name[32])
{
	if (!g->is_word || strlen(g->token) > 31)
		glsl_fail(g, "expected a name");
	strcpy(name, g->token);
	glsl_next(g);
}

static inline enum glsl_type glsl_type_of(const char *name)
{
	static const char *const names[] = {"void", "bool", "int", "float", "vec2", "vec3"};
	for (enum glsl_type t = GLSL_VOID; t <= GLSL_VEC3; t++)
		if (!strcmp(names[t], name))
			return t;
	return GLSL_ARRAY;
}

/* The tree */

static inline struct glsl_node *glsl_node(struct glsl *g, enum glsl_kind kind, const char *name)
{
	struct glsl_node *node = glsl_alloc(g, sizeof *node);
	node->kind = kind;
	assert_true(strlen(name) < sizeof node->name);
	strcpy(node->name, name);
	return node;
}

static inline void glsl_add(struct glsl *g, struct glsl_node *node, struct glsl_node *item)
{
	if (!node->item)
		node->item = glsl_alloc(g, GLSL_ITEMS * sizeof *node->item);
	assert_true(node->n < GLSL_ITEMS);
	node->item[node->n++] = item;
}

static inline struct glsl_node *glsl_expression(struct glsl *g);
static inline struct glsl_node *glsl_statement(struct glsl *g);

static inline struct glsl_node *glsl_literal(struct glsl *g)
{
	struct glsl_node *node = glsl_node(g, GLSL_LITERAL, "");
	char *end;
	const bool is_float = strpbrk(g->token, ".e");
	node->value.type = is_float ? GLSL_FLOAT : GLSL_INT;
	node->value.v[0] = strtod(g->token, &end);
	if (*end || isinf(node->value.v[0]))
		glsl_fail(g, "no number");
	if (is_float)
		node->value.v[0] = glsl_round(g, node->value.v[0]);
	glsl_next(g);
	return node;
}

static inline struct glsl_node *glsl_primary(struct glsl *g)
{
	char name[32];
	struct glsl_node *node;
	if (g->is_number) {
		node = glsl_literal(g);
	} else if (glsl_take(g, "(")) {
		node = glsl_expression(g);
		glsl_expect(g, ")");
	} else {
		glsl_word(g, name);
		if (glsl_take(g, "(")) {
			node = glsl_node(g, GLSL_CALL, name);
			while (!glsl_take(g, ")")) {
				glsl_add(g, node, glsl_expression(g));
				if (!glsl_is(g, ")"))
					glsl_expect(g, ",");
			}
		} else {
			node = glsl_node(g, GLSL_NAME, name);
		}
	}
	for (;;) {
		if (glsl_take(g, "[")) {
			struct glsl_node *index = glsl_node(g, GLSL_INDEX, "");
			glsl_add(g, index, node);
			glsl_add(g, index, glsl_expression(g));
			glsl_expect(g, "]");
			node = index;
		} else if (glsl_take(g, ".")) {
			glsl_word(g, name);
			struct glsl_node *field = glsl_node(g, GLSL_FIELD, name);
			glsl_add(g, field, node);
			node = field;
		} else {
			return node;
		}
	}
}

static inline struct glsl_node *glsl_unary(struct glsl *g)
{
	if (!glsl_is(g, "-") && !glsl_is(g, "!"))
		return glsl_primary(g);
	struct glsl_node *node = glsl_node(g, GLSL_UNARY, g->token);
	glsl_next(g);
	glsl_add(g, node, glsl_unary(g));
	return node;
}

/* Operators by rank, lowest first. */
static inline struct glsl_node *glsl_binary(struct glsl *g, int rank)
{
	static const char *const operators[][5] = {{"||"},     {"&&"},    {"==", "!="}, {"<", ">", "<=", ">="},
						   {"+", "-"}, {"*", "/"}};
	if (rank == 6)
		return glsl_unary(g);
	struct glsl_node *left = glsl_binary(g, rank + 1);
	for (int i = 0; operators[rank][i]; i++) {
		if (!glsl_is(g, operators[rank][i]))
			continue;
		struct glsl_node *node = glsl_node(g, GLSL_BINARY, g->token);
		glsl_next(g);
		glsl_add(g, node, left);
		glsl_add(g, node, glsl_binary(g, rank + 1));
		left = node;
		i = -1;
	}
	return left;
}

static inline struct glsl_node *glsl_expression(struct glsl *g)
{
	struct glsl_node *condition = glsl_binary(g, 0);
	if (!glsl_take(g, "?"))
		return condition;
	struct glsl_node *node = glsl_node(g, GLSL_SELECT, "");
	glsl_add(g, node, condition);
	glsl_add(g, node, glsl_expression(g));
	glsl_expect(g, ":");
	glsl_add(g, node, glsl_expression(g));
	return node;
}

/* A declaration or an assignment, without what ends it. */
static inline struct glsl_node *glsl_simple(struct glsl *g)
{
	char name[32];
	const enum glsl_type type = glsl_type_of(g->token);
	if (type != GLSL_ARRAY) {
		glsl_next(g);
		glsl_word(g, name);
		struct glsl_node *node = glsl_node(g, GLSL_DECLARE, name);
		node->type = type;
		glsl_expect(g, "=");
		glsl_add(g, node, glsl_expression(g));
		return node;
	}
	glsl_word(g, name);
	struct glsl_node *node = glsl_node(g, GLSL_ASSIGN, name);
	const bool counts = glsl_is(g, "++") || glsl_is(g, "--");
	node->value.n = glsl_is(g, "=") ? 0 : g->token[0]; /* the operator */
	glsl_next(g);
	if (counts) {
		struct glsl_node *one = glsl_node(g, GLSL_LITERAL, "");
		one->value = (struct glsl_value){.type = GLSL_INT, .v = {1}};
		glsl_add(g, node, one);
	} else {
		glsl_add(g, node, glsl_expression(g));
	}
	return node;
}

static inline struct glsl_node *glsl_block(struct glsl *g)
{
	struct glsl_node *node = glsl_node(g, GLSL_BLOCK, "");
	while (!glsl_take(g, "}"))
		glsl_add(g, node, glsl_statement(g));
	return node;
}

static inline struct glsl_node *glsl_statement(struct glsl *g)
{
	struct glsl_node *node;
	if (glsl_take(g, "{"))
		return glsl_block(g);
	if (glsl_take(g, "if")) {
		node = glsl_node(g, GLSL_IF, "");
		glsl_expect(g, "(");
		glsl_add(g, node, glsl_expression(g));
		glsl_expect(g, ")");
		glsl_add(g, node, glsl_statement(g));
		if (glsl_take(g, "else"))
			glsl_add(g, node, glsl_statement(g));
		return node;
	}
	if (glsl_take(g, "for")) {
		node = glsl_node(g, GLSL_FOR, "");
		glsl_expect(g, "(");
		glsl_add(g, node, glsl_simple(g));
		glsl_expect(g, ";");
		glsl_add(g, node, glsl_expression(g));
		glsl_expect(g, ";");
		glsl_add(g, node, glsl_simple(g));
		glsl_expect(g, ")");
		glsl_add(g, node, glsl_statement(g));
		return node;
	}
	if (glsl_take(g, "return")) {
		node = glsl_node(g, GLSL_RETURN, "");
		glsl_add(g, node, glsl_expression(g));
	} else if (glsl_take(g, "break")) {
		node = glsl_node(g, GLSL_BREAK, "");
	} else {
		node = glsl_simple(g);
	}
	glsl_expect(g, ";");
	return node;
}

/* Values */

static inline struct glsl_value glsl_float(const struct glsl *g, double x)
{
	return (struct glsl_value){.type = GLSL_FLOAT, .v = {glsl_round(g, x)}};
}

static inline struct glsl_value glsl_bool(bool x)
{
	return (struct glsl_value){.type = GLSL_BOOL, .v = {x}};
}

static inline int glsl_size(enum glsl_type type)
{
	return type == GLSL_VEC3 ? 3 : type == GLSL_VEC2 ? 2 : 1;
}

static inline struct glsl_variable *glsl_find(struct glsl *g, const char *name)
{
	for (int i = g->n_variables - 1; i >= g->frame; i--)
		if (!strcmp(g->variable[i].name, name))
			return &g->variable[i];
	for (int i = g->n_globals - 1; i >= 0; i--)
		if (!strcmp(g->variable[i].name, name))
			return &g->variable[i];
	fail_msg("GLSL: nothing is called '%s'", name);
	return NULL;
}

static inline void glsl_declare(struct glsl *g, const char *name, struct glsl_value value, bool constant)
{
	assert_true(g->n_variables < GLSL_VARIABLES);
	struct glsl_variable *variable = &g->variable[g->n_variables++];
	strcpy(variable->name, name);
	variable->value = value;
	variable->constant = constant;
}

static inline double glsl_operate(const struct glsl *g, char operator, double a, double b, bool integer)
{
	const double x = operator== '+' ? a + b : operator== '-' ? a - b : operator== '*' ? a * b : a / b;
	return integer ? trunc(x) : glsl_round(g, x);
}

/* Component by component; a float goes with each component of a vector. */
static inline struct glsl_value glsl_arithmetic(const struct glsl *g, char operator, struct glsl_value a,
						struct glsl_value b)
{
	const bool vector_a = a.type >= GLSL_VEC2, vector_b = b.type >= GLSL_VEC2;
	if (a.type < GLSL_INT || a.type > GLSL_VEC3 || b.type > GLSL_VEC3 ||
	    (a.type != b.type && !(vector_a && b.type == GLSL_FLOAT) && !(vector_b && a.type == GLSL_FLOAT)))
		fail_msg("GLSL: types %d and %d do not go with '%c'", (int)a.type, (int)b.type, operator);
	struct glsl_value result = {.type = vector_b ? b.type : a.type};
	for (int c = 0; c < glsl_size(result.type); c++)
		result.v[c] =
			glsl_operate(g, operator, a.v[vector_a ? c : 0], b.v[vector_b ? c : 0], a.type == GLSL_INT);
	return result;
}

static inline struct glsl_value glsl_eval(struct glsl *g, const struct glsl_node *node);

static inline struct glsl_value glsl_eval_binary(struct glsl *g, const struct glsl_node *node)
{
	const char *name = node->name;
	const struct glsl_value a = glsl_eval(g, node->item[0]);
	if (!strcmp(name, "&&") || !strcmp(name, "||")) {
		assert_int_equal(a.type, GLSL_BOOL);
		return (a.v[0] != 0) == (name[0] == '|') ? a : glsl_eval(g, node->item[1]);
	}
	const struct glsl_value b = glsl_eval(g, node->item[1]);
	if (!strchr("<>=!", name[0]))
		return glsl_arithmetic(g, name[0], a, b);
	if (a.type != b.type || a.type > GLSL_FLOAT)
		fail_msg("GLSL: types %d and %d do not compare", (int)a.type, (int)b.type);
	const double x = a.v[0], y = b.v[0];
	return glsl_bool(!strcmp(name, "<")    ? x < y
			 : !strcmp(name, ">")  ? x > y
			 : !strcmp(name, "<=") ? x <= y
			 : !strcmp(name, ">=") ? x >= y
			 : !strcmp(name, "==") ? x == y
					       : x != y);
}

static inline double glsl_dot(const struct glsl *g, struct glsl_value a, struct glsl_value b)
{
	double sum = 0;
	assert_true(a.type == b.type && a.type >= GLSL_VEC2 && a.type <= GLSL_VEC3);
	for (int c = 0; c < glsl_size(a.type); c++)
		sum = glsl_round(g, sum + glsl_round(g, a.v[c] * b.v[c]));
	return sum;
}

/* Functions of floats that GLSL has itself. */
static inline bool glsl_builtin(const char *name, int n, double x, double y, double *result)
{
	static const struct {
		const char *name;
		double (*f)(double);
	} one[] = {{"sqrt", sqrt}, {"exp", exp}, {"log", log}, {"log2", log2}, {"abs", fabs}, {"floor", floor}};
	for (size_t i = 0; i < sizeof one / sizeof *one && n == 1; i++)
		if (!strcmp(one[i].name, name)) {
			*result = one[i].f(x);
			return true;
		}
	if (n != 2)
		return false;
	if (!strcmp(name, "min"))
		*result = y < x ? y : x;
	else if (!strcmp(name, "max"))
		*result = x < y ? y : x;
	else if (!strcmp(name, "atan"))
		*result = atan2(x, y);
	else
		return false;
	return true;
}

static inline struct glsl_value glsl_run(struct glsl *g, const struct glsl_function *function,
					 const struct glsl_value *argument, int n);

static inline struct glsl_value glsl_call(struct glsl *g, const struct glsl_node *node)
{
	struct glsl_value a[8];
	double result = NAN;
	assert_true(node->n <= 8);
	for (int i = 0; i < node->n; i++)
		a[i] = glsl_eval(g, node->item[i]);
	for (int i = 0; i < g->n_functions; i++)
		if (!strcmp(g->function[i].name, node->name))
			return glsl_run(g, &g->function[i], a, node->n);
	const bool one = node->n == 1, number = one && (a[0].type == GLSL_FLOAT || a[0].type == GLSL_INT);
	if (!strcmp(node->name, "float") && number)
		return glsl_float(g, a[0].v[0]);
	if (!strcmp(node->name, "int") && number) {
		check_between(a[0].v[0], -2147483648.0, 2147483647.0, "GLSL: int()");
		return (struct glsl_value){.type = GLSL_INT, .v = {trunc(a[0].v[0])}};
	}
	if (!strcmp(node->name, "length") && one)
		return glsl_float(g, sqrt(glsl_dot(g, a[0], a[0])));
	if (!strcmp(node->name, "dot") && node->n == 2)
		return glsl_float(g, glsl_dot(g, a[0], a[1]));
	for (int i = 0; i < node->n; i++)
		if (a[i].type != GLSL_FLOAT)
			fail_msg("GLSL: argument %d of %s() is no float", i, node->name);
	if (!strcmp(node->name, "vec3") && (one || node->n == 3))
		return (struct glsl_value){.type = GLSL_VEC3,
					   .v = {a[0].v[0], a[one ? 0 : 1].v[0], a[one ? 0 : 2].v[0]}};
	if (!node->n || !glsl_builtin(node->name, node->n, a[0].v[0], node->n > 1 ? a[1].v[0] : 0, &result))
		fail_msg("GLSL: no function %s() of %d", node->name, node->n);
	return glsl_float(g, result);
}

static inline struct glsl_value glsl_field(struct glsl *g, const struct glsl_node *node)
{
	const struct glsl_value a = glsl_eval(g, node->item[0]);
	assert_int_equal(a.type, GLSL_VEC3);
	if (!strcmp(node->name, "xy"))
		return (struct glsl_value){.type = GLSL_VEC2, .v = {a.v[0], a.v[1]}};
	const int c = node->name[0] - 'x';
	if (c < 0 || c > 2 || node->name[1])
		fail_msg("GLSL: no field .%s", node->name);
	return glsl_float(g, a.v[c]);
}

static inline struct glsl_value glsl_eval(struct glsl *g, const struct glsl_node *node)
{
	struct glsl_value a, b;
	switch (node->kind) {
	case GLSL_LITERAL:
		return node->value;
	case GLSL_NAME:
		return glsl_find(g, node->name)->value;
	case GLSL_UNARY:
		a = glsl_eval(g, node->item[0]);
		if (node->name[0] == '!')
			return glsl_bool(a.v[0] == 0);
		for (int c = 0; c < 3; c++)
			a.v[c] = -a.v[c];
		return a;
	case GLSL_BINARY:
		return glsl_eval_binary(g, node);
	case GLSL_SELECT:
		a = glsl_eval(g, node->item[0]);
		assert_int_equal(a.type, GLSL_BOOL);
		return glsl_eval(g, node->item[a.v[0] != 0 ? 1 : 2]);
	case GLSL_CALL:
		return glsl_call(g, node);
	case GLSL_INDEX:
		a = glsl_eval(g, node->item[0]);
		b = glsl_eval(g, node->item[1]);
		if (a.type != GLSL_ARRAY || b.type != GLSL_INT || b.v[0] < 0 || b.v[0] >= a.n)
			fail_msg("GLSL: no element %g of %d", b.v[0], a.n);
		return glsl_float(g, a.array[(int)b.v[0]]);
	case GLSL_FIELD:
		return glsl_field(g, node);
	default:
		fail_msg("GLSL: no expression");
		return (struct glsl_value){0};
	}
}

/* Statements */

enum glsl_flow { GLSL_ON, GLSL_LEAVE_LOOP, GLSL_LEAVE_FUNCTION };

static inline void glsl_assign(struct glsl *g, const struct glsl_node *node)
{
	const struct glsl_value value = glsl_eval(g, node->item[0]);
	struct glsl_variable *variable = glsl_find(g, node->name);
	if (variable->constant)
		fail_msg("GLSL: '%s' is constant", node->name);
	const struct glsl_value result =
		node->value.n ? glsl_arithmetic(g, (char)node->value.n, variable->value, value) : value;
	assert_int_equal(result.type, variable->value.type);
	variable->value = result;
}

static inline enum glsl_flow glsl_execute(struct glsl *g, const struct glsl_node *node)
{
	enum glsl_flow flow = GLSL_ON;
	const int locals = g->n_variables;
	struct glsl_value value;
	switch (node->kind) {
	case GLSL_DECLARE:
		value = glsl_eval(g, node->item[0]);
		if (value.type != node->type)
			fail_msg("GLSL: '%s' is of type %d, not %d", node->name, (int)node->type, (int)value.type);
		glsl_declare(g, node->name, value, false);
		return GLSL_ON;
	case GLSL_ASSIGN:
		glsl_assign(g, node);
		return GLSL_ON;
	case GLSL_RETURN:
		g->returned = glsl_eval(g, node->item[0]);
		return GLSL_LEAVE_FUNCTION;
	case GLSL_BREAK:
		return GLSL_LEAVE_LOOP;
	case GLSL_IF:
		value = glsl_eval(g, node->item[0]);
		assert_int_equal(value.type, GLSL_BOOL);
		if (value.v[0] != 0)
			return glsl_execute(g, node->item[1]);
		return node->n > 2 ? glsl_execute(g, node->item[2]) : GLSL_ON;
	case GLSL_BLOCK:
		for (int i = 0; i < node->n && flow == GLSL_ON; i++)
			flow = glsl_execute(g, node->item[i]);
		break;
	case GLSL_FOR:
		for (glsl_execute(g, node->item[0]); glsl_eval(g, node->item[1]).v[0] != 0;
		     glsl_execute(g, node->item[2])) {
			flow = glsl_execute(g, node->item[3]);
			if (flow != GLSL_ON)
				break;
		}
		if (flow == GLSL_LEAVE_LOOP)
			flow = GLSL_ON;
		break;
	default:
		fail_msg("GLSL: no statement");
	}
	g->n_variables = locals;
	return flow;
}

static inline struct glsl_value glsl_run(struct glsl *g, const struct glsl_function *function,
					 const struct glsl_value *argument, int n)
{
	const int frame = g->frame, variables = g->n_variables;
	assert_int_equal(n, function->n_parameters);
	assert_true(++g->depth < GLSL_DEPTH);
	for (int i = 0; i < n; i++) {
		if (argument[i].type != function->parameter[i].value.type)
			fail_msg("GLSL: argument %d of %s() is of type %d", i, function->name, (int)argument[i].type);
		glsl_declare(g, function->parameter[i].name, argument[i], false);
	}
	g->frame = variables;
	if (glsl_execute(g, function->body) != GLSL_LEAVE_FUNCTION || g->returned.type != function->returns)
		fail_msg("GLSL: %s() returns nothing, or another type", function->name);
	g->frame = frame;
	g->n_variables = variables;
	g->depth--;
	return g->returned;
}

/* The program */

static inline void glsl_constant_array(struct glsl *g, const char *name)
{
	const int n = (int)strtol(g->token, NULL, 10);
	double *array = glsl_alloc(g, (size_t)n * sizeof *array);
	char again[64];
	strcpy(again, g->token);
	glsl_next(g);
	glsl_expect(g, "]");
	glsl_expect(g, "=");
	glsl_expect(g, "float");
	glsl_expect(g, "[");
	glsl_expect(g, again);
	glsl_expect(g, "]");
	glsl_expect(g, "(");
	for (int i = 0; i < n; i++) {
		const double sign = glsl_take(g, "-") ? -1 : 1;
		const struct glsl_node *literal = glsl_literal(g);
		assert_int_equal(literal->value.type, GLSL_FLOAT);
		array[i] = sign * literal->value.v[0];
		glsl_expect(g, i < n - 1 ? "," : ")");
	}
	glsl_expect(g, ";");
	glsl_declare(g, name, (struct glsl_value){.type = GLSL_ARRAY, .array = array, .n = n}, true);
}

static inline void glsl_constant(struct glsl *g)
{
	char name[32];
	const enum glsl_type type = glsl_type_of(g->token);
	glsl_next(g);
	glsl_word(g, name);
	if (glsl_take(g, "[")) {
		glsl_constant_array(g, name);
	} else {
		glsl_expect(g, "=");
		const struct glsl_value value = glsl_eval(g, glsl_expression(g));
		if (value.type != type)
			glsl_fail(g, "a constant of another type");
		glsl_expect(g, ";");
		glsl_declare(g, name, value, true);
	}
	g->n_globals = g->n_variables;
}

static inline void glsl_parse_function(struct glsl *g)
{
	assert_true(g->n_functions < GLSL_FUNCTIONS);
	struct glsl_function *function = &g->function[g->n_functions];
	function->returns = glsl_type_of(g->token);
	if (function->returns == GLSL_ARRAY)
		glsl_fail(g, "no type");
	glsl_next(g);
	glsl_word(g, function->name);
	for (int i = 0; i < g->n_functions; i++)
		assert_string_not_equal(function->name, g->function[i].name);
	glsl_expect(g, "(");
	while (!glsl_take(g, ")")) {
		struct glsl_variable *parameter = &function->parameter[function->n_parameters++];
		assert_true(function->n_parameters <= 8);
		parameter->value.type = glsl_type_of(g->token);
		glsl_next(g);
		glsl_word(g, parameter->name);
		if (!glsl_is(g, ")"))
			glsl_expect(g, ",");
	}
	glsl_expect(g, "{");
	function->body = glsl_block(g);
	g->n_functions++; /* only now: no recursion, as in GLSL */
}

/* glsl_open - a program of constants and functions; `rounds`: in floats. glsl_free() releases it. */
static inline struct glsl *glsl_open(const char *text, bool rounds)
{
	struct glsl *g = calloc(1, sizeof *g);
	assert_non_null(g);
	g->text = g->at = text;
	g->rounds = rounds;
	glsl_next(g);
	return g;
}

/* glsl_parse - reads the program, after its uniforms have been declared. */
static inline void glsl_parse(struct glsl *g)
{
	g->n_globals = g->n_variables;
	while (*g->token)
		if (glsl_take(g, "const"))
			glsl_constant(g);
		else
			glsl_parse_function(g);
	g->frame = g->n_globals;
}

/* glsl_function - calls a function of the program by its name. */
static inline struct glsl_value glsl_function(struct glsl *g, const char *name, const struct glsl_value *argument,
					      int n)
{
	for (int i = 0; i < g->n_functions; i++)
		if (!strcmp(g->function[i].name, name))
			return glsl_run(g, &g->function[i], argument, n);
	fail_msg("GLSL: no function %s()", name);
	return (struct glsl_value){0};
}

#endif
